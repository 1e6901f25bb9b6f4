#pragma once
// When a frame arrived, on the daemon's clock, from the stamps that the kernel gives with it. The
// software stamp is of the machine's real-time clock, which may be set at any moment: how old it
// was when it was read tells the arrival, and where that clock was set meanwhile, nothing does.
//
//   read a frame;  look(both clocks, read now);  arrived_us(its stamps)
//   the queue is empty:  drained();  look(...)
//
// Thread: one at a time.

#include <algorithm>
#include <cstdint>

#include "port/linux/can/hardware_clock.hpp"

namespace flatpose::port {

/// 0: there is none.
struct CanStamps {
  std::int64_t software_us = 0;
  std::int64_t hardware_us = 0;
};

class ArrivalClock {
 public:
  /// The real-time clock was set when it moved by more than this against the daemon's; less is two
  /// readings that do not fit, or drift.
  static constexpr std::int64_t kStep_us = 10'000;
  /// Nothing is held to be older than this.
  static constexpr std::int64_t kAgeMost_us = 10'000'000;

  /// Both clocks, read together after what arrived_us() is asked about.
  void look(std::int64_t now_us, std::int64_t real_us) noexcept {
    const std::int64_t moved_us = (real_us - now_us) - (real_us_ - now_us_);
    if (has_looked_ && (moved_us > kStep_us || moved_us < -kStep_us)) was_set_ = true;
    has_looked_ = true;
    now_us_ = now_us;
    real_us_ = real_us;
  }

  /// Nothing waits that was stamped before the clock was set.
  void drained() noexcept { was_set_ = false; }

  /// Never after the look.
  [[nodiscard]] std::int64_t arrived_us(const CanStamps& stamps) noexcept {
    if (was_set_ || stamps.software_us == 0) return now_us_;
    const std::int64_t age_us =
        std::clamp<std::int64_t>(real_us_ - stamps.software_us, 0, kAgeMost_us);
    return hardware_.arrived_us(stamps.hardware_us, now_us_ - age_us);
  }

 private:
  bool has_looked_ = false;
  bool was_set_ = false;
  std::int64_t now_us_ = 0;
  std::int64_t real_us_ = 0;
  HardwareClock hardware_;
};

}  // namespace flatpose::port
