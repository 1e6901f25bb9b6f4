#pragma once
// When a TPDO, or the whole result's frame, goes out: at an event, no sooner than its inhibit time
// allows, again when its event timer has run, or with SYNC (CiA 301, 7.5.2.37).

#include <algorithm>
#include <cstdint>

#include "flatpose/can/heartbeat.hpp"

namespace flatpose::can {

struct TpdoSettings {
  bool is_valid = true;
  /// 0: with the next SYNC after an event; 1 to 240: with every so manyth SYNC; 254, 255: at the
  /// event.
  std::uint8_t type = 254;
  std::uint16_t inhibit_100us = 10;  ///< From one to the next, in 0.1 ms.
  std::uint16_t event_timer_ms = 0;  ///< At the latest after this; 0: only at events.

  friend bool operator==(const TpdoSettings&, const TpdoSettings&) = default;
};

[[nodiscard]] constexpr bool is_transmission_type(std::uint32_t type) noexcept {
  return type <= 240 || type == 254 || type == 255;
}

class TransmitPdo {
 public:
  /// The node has become operational, or the settings have changed.
  void restart(const TpdoSettings& settings, std::int64_t now_us) noexcept {
    settings_ = settings;
    is_pending_ = is_released_ = false;
    sync_count_ = 0;
    timer_us_ = after_timer(now_us);
  }
  void stop() noexcept {
    is_pending_ = is_released_ = false;
    timer_us_ = kNever_us;
    settings_.is_valid = false;
  }

  /// The content has changed.
  void event() noexcept { is_pending_ = settings_.is_valid; }

  void sync() noexcept {
    if (!settings_.is_valid || is_by_event()) return;
    if (settings_.type == 0) {
      is_released_ = is_pending_;
    } else if (++sync_count_ >= settings_.type) {
      sync_count_ = 0;
      is_released_ = true;
    }
  }

  [[nodiscard]] bool is_due(std::int64_t now_us) const noexcept {
    if (!settings_.is_valid) return false;
    if (!is_by_event()) return is_released_;
    return now_us >= timer_us_ || (is_pending_ && now_us >= inhibited_until_us_);
  }
  void sent(std::int64_t now_us) noexcept {
    is_pending_ = is_released_ = false;
    inhibited_until_us_ = now_us + std::int64_t{settings_.inhibit_100us} * 100;
    timer_us_ = after_timer(now_us);
  }
  /// It found no room: it is to be made anew.
  void not_sent() noexcept {
    if (!settings_.is_valid) return;
    (is_by_event() ? is_pending_ : is_released_) = true;
    inhibited_until_us_ = 0;
  }
  [[nodiscard]] std::int64_t next_us() const noexcept {
    if (!settings_.is_valid || !is_by_event()) return kNever_us;
    return is_pending_ ? std::min(timer_us_, inhibited_until_us_) : timer_us_;
  }

 private:
  [[nodiscard]] bool is_by_event() const noexcept { return settings_.type >= 254; }
  [[nodiscard]] std::int64_t after_timer(std::int64_t now_us) const noexcept {
    const bool is_timed = settings_.is_valid && is_by_event() && settings_.event_timer_ms > 0;
    return is_timed ? now_us + std::int64_t{settings_.event_timer_ms} * 1000 : kNever_us;
  }

  TpdoSettings settings_{.is_valid = false};
  bool is_pending_ = false;   ///< Something to tell.
  bool is_released_ = false;  ///< SYNC lets it go.
  int sync_count_ = 0;
  std::int64_t inhibited_until_us_ = 0;
  std::int64_t timer_us_ = kNever_us;
};

}  // namespace flatpose::can
