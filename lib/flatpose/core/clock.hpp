#pragma once
// Time as an interface: lib never asks the operating system for it.

#include <cstdint>

namespace flatpose {

class Clock {
 public:
  /// Microseconds since any fixed moment; never runs back.
  [[nodiscard]] virtual std::int64_t now_us() const noexcept = 0;

 protected:
  ~Clock() = default;
};

/// No time at all: every timing is zero and no deadline passes.
class StoppedClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const noexcept override { return 0; }
};

}  // namespace flatpose
