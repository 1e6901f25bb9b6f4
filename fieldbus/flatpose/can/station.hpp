#pragma once
// A device on a link: what came is served, what may go is sent, and a frame that found no room
// waits for the next call, while all after it is made only then.

#include <algorithm>
#include <cstdint>

#include "flatpose/can/device.hpp"
#include "flatpose/can/link.hpp"

namespace flatpose::can {

/// Frames served in one call, and sent; what is more comes with the next.
inline constexpr int kFramesPerTurn = 64;
/// A bus without room is tried again after this, then after twice as long, and so on.
inline constexpr std::int64_t kRetry_us = 1000;
inline constexpr std::int64_t kRetryMost_us = 64'000;

class Station {
 public:
  /// Refers to both, which must outlive it.
  Station(Device& device, Link& link) noexcept : device_(device), link_(link) {}

  /// Call it when the link has something, when the machine was called by others, and at next_us().
  /// Returns what the machine said, as Device::process.
  job::Outputs serve(std::int64_t now_us) noexcept;

  [[nodiscard]] std::int64_t next_us() const noexcept {
    if (is_off_) return std::max(device_.next_us(), served_us_ + kRetryMost_us);
    if (has_more_) return served_us_;
    return has_waiting_ ? served_us_ + retry_us_ : device_.next_us();
  }

  /// Frames that found no room at first.
  [[nodiscard]] std::uint32_t blocked_count() const noexcept { return blocked_count_; }

 private:
  void send(std::int64_t now_us) noexcept;

  Device& device_;
  Link& link_;
  Frame waiting_;
  bool has_waiting_ = false;
  bool has_more_ = false;  ///< There may be more to receive or to send than one call does.
  bool is_off_ = false;
  std::int64_t served_us_ = 0;
  std::int64_t retry_us_ = kRetry_us;
  std::uint32_t blocked_count_ = 0;
};

}  // namespace flatpose::can
