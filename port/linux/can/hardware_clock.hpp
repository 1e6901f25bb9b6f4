#pragma once
// The clock of a CAN controller, which stamps frames as they come off the wire, against the
// daemon's own. It starts anywhere, drifts, and starts again with its adapter.
//
//   software stamp  =  arrival + what the interrupt took          (daemon's clock)
//   hardware stamp  =  arrival - offset                           (controller's clock)
//
// So the least difference seen of late is the offset, and what a frame's own difference is above it
// was the interrupt's. It is used as long as it is plausible, else the software stamp.
//
// Error: that of the quickest interrupt in the window, and what the clock drifts in it: 0.2 ms at
// 100 ppm.  Memory: fixed.  Thread: one at a time.

#include <algorithm>
#include <cstdint>
#include <limits>

namespace flatpose::port {

class HardwareClock {
 public:
  /// The least difference is that of the last one to two of these.
  static constexpr std::int64_t kWindow_us = 1'000'000;
  /// No interrupt waits longer: a frame that would have is of a clock that has started again.
  static constexpr std::int64_t kDelayMost_us = 50'000;

  /// When a frame arrived, on the daemon's clock: at `software_us` or before.  Frames in the order
  /// of their arrival.
  [[nodiscard]] std::int64_t arrived_us(std::int64_t hardware_us,
                                        std::int64_t software_us) noexcept {
    if (hardware_us <= 0 || hardware_us > kStampMost_us) return software_us;
    if (hardware_us <= last_us_) forget();  // it stands still, or has started again
    last_us_ = hardware_us;
    const std::int64_t difference_us = software_us - hardware_us;
    turn_window(software_us);
    least_us_ = std::min(least_us_, difference_us);
    const std::int64_t delay_us = difference_us - std::min(least_us_, least_before_us_);
    if (delay_us <= kDelayMost_us) return software_us - delay_us;
    forget();
    last_us_ = hardware_us;
    return software_us;
  }

 private:
  static constexpr std::int64_t kNone_us = std::numeric_limits<std::int64_t>::max();
  static constexpr std::int64_t kStampMost_us = std::int64_t{1} << 60;

  void forget() noexcept { *this = {}; }
  void turn_window(std::int64_t now_us) noexcept {
    if (least_us_ == kNone_us) begun_us_ = now_us;
    if (now_us - begun_us_ < kWindow_us) return;
    least_before_us_ = now_us - begun_us_ < 2 * kWindow_us ? least_us_ : kNone_us;
    least_us_ = kNone_us;
    begun_us_ = now_us;
  }

  std::int64_t last_us_ = 0;
  std::int64_t begun_us_ = 0;
  std::int64_t least_us_ = kNone_us;         ///< Of this window,
  std::int64_t least_before_us_ = kNone_us;  ///< and of the one before.
};

}  // namespace flatpose::port
