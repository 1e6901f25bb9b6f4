#pragma once
// How long each stage took, by the host's clock.

#include <cstdint>

#include "flatpose/core/clock.hpp"

namespace flatpose::locate {

class Stopwatch {
 public:
  explicit Stopwatch(const Clock& clock) noexcept
      : clock_(clock), start_us_(clock.now_us()), lap_us_(start_us_) {}

  [[nodiscard]] std::int64_t start_us() const noexcept { return start_us_; }
  /// Since the last call, or since the start.
  std::int64_t lap_us() noexcept {
    const std::int64_t now_us = clock_.now_us();
    const std::int64_t lap_us = now_us - lap_us_;
    lap_us_ = now_us;
    return lap_us;
  }
  [[nodiscard]] std::int64_t total_us() const noexcept { return clock_.now_us() - start_us_; }

 private:
  const Clock& clock_;
  std::int64_t start_us_;
  std::int64_t lap_us_;
};

}  // namespace flatpose::locate
