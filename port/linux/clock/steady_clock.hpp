#pragma once
// The machine's monotonic time for what lib measures.

#include <chrono>

#include "flatpose/core/clock.hpp"

namespace flatpose::port {

class SteadyClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const noexcept override {
    const auto since_start = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::microseconds>(since_start).count();
  }
};

}  // namespace flatpose::port
