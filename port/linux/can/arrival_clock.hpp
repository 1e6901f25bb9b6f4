#pragma once
// When a frame arrived, on the daemon's clock, from the stamps that the kernel gives with it. The
// software stamp is of the machine's real-time clock, which may be set at any moment: how old it
// was when it was read tells the arrival. What waited while that clock was set bears a stamp of
// before or of after, and what fits between the frame before and now is taken, the later of two.
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
    if (has_looked_ && (moved_us > kStep_us || moved_us < -kStep_us)) {
      if (!was_set_) offset_before_us_ = real_us_ - now_us_;
      was_set_ = true;
    }
    has_looked_ = true;
    now_us_ = now_us;
    real_us_ = real_us;
  }

  /// Nothing waits that was stamped before the clock was set.
  void drained() noexcept {
    was_set_ = false;
    last_us_ = now_us_;
  }

  /// Never after the look, and the look where nothing tells.
  [[nodiscard]] std::int64_t arrived_us(const CanStamps& stamps) noexcept {
    if (stamps.software_us == 0) return now_us_;
    if (was_set_) return last_us_ = fitting_us(stamps.software_us);
    const std::int64_t age_us =
        std::clamp<std::int64_t>(real_us_ - stamps.software_us, 0, kAgeMost_us);
    last_us_ = now_us_ - age_us;
    return hardware_.arrived_us(stamps.hardware_us, last_us_);
  }

 private:
  [[nodiscard]] std::int64_t fitting_us(std::int64_t stamp_us) const noexcept {
    const std::int64_t by_old_us = stamp_us - offset_before_us_;
    const std::int64_t by_new_us = stamp_us - (real_us_ - now_us_);
    const auto fits = [this](std::int64_t us) { return us >= last_us_ && us <= now_us_; };
    if (fits(by_old_us) && fits(by_new_us)) return std::max(by_old_us, by_new_us);
    if (fits(by_old_us)) return by_old_us;
    return fits(by_new_us) ? by_new_us : now_us_;
  }

  bool has_looked_ = false;
  bool was_set_ = false;
  std::int64_t now_us_ = 0;
  std::int64_t real_us_ = 0;
  std::int64_t last_us_ = 0;           ///< What comes next arrived no earlier.
  std::int64_t offset_before_us_ = 0;  ///< Of the clocks, before one was set.
  HardwareClock hardware_;
};

}  // namespace flatpose::port
