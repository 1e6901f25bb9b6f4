#pragma once
// A device on a link: what came is served, at the time at which it came, and what may go is sent. A
// frame that found no room waits for the next call, while all after it is made only then.
//
// Time alone passes only when the link is empty: after a stall, what came in time is in time.

#include <algorithm>
#include <cstdint>

#include "flatpose/can/device.hpp"
#include "flatpose/can/link.hpp"

namespace flatpose::can {

/// Frames served in one call; more than a socket usually holds. What is more comes with the next.
inline constexpr int kFramesPerTurn = 512;
/// And sent.
inline constexpr int kSendsPerTurn = 64;
/// A bus without room is tried again after this, then after twice as long, and so on.
inline constexpr std::int64_t kRetry_us = 1000;
inline constexpr std::int64_t kRetryMost_us = 64'000;

class Station {
 public:
  /// Refers to both, which must outlive it.
  Station(Device& device, Link& link) noexcept : device_(device), link_(link) {}

  /// Call it when the link has something, and at next_us(); before the machine is called by others,
  /// for what it brings came earlier.  Returns what the machine said, as Device::process; an
  /// order's time is `now_us`, for no scan begun before may count, while its answer_by counts from
  /// the frame's arrival.
  job::Outputs serve(std::int64_t now_us) noexcept;

  /// Call it when the machine was called by others: tells what has changed. It reads nothing, so no
  /// time passes for the node either: meanwhile a heartbeat may have come.
  job::Outputs tell(std::int64_t now_us) noexcept;

  [[nodiscard]] std::int64_t next_us() const noexcept {
    if (has_more_) return served_us_;
    if (is_off_) return std::max(device_.next_us(), served_us_ + kRetryMost_us);
    return is_blocked_ ? retry_at_us_ : device_.next_us();
  }

  /// Frames that found no room at first.
  [[nodiscard]] std::uint32_t blocked_count() const noexcept { return blocked_count_; }

 private:
  void take_in(const Link::Received& got, std::int64_t now_us, job::Outputs& all) noexcept;
  void send(std::int64_t now_us) noexcept;
  void found_no_room(std::int64_t now_us) noexcept;

  Device& device_;
  Link& link_;
  Frame waiting_;
  bool has_waiting_ = false;
  bool is_blocked_ = false;
  bool has_more_ = false;  ///< There may be more to receive or to send than one call does.
  bool is_off_ = false;
  std::int64_t passed_us_ = 0;  ///< All that came before has been served.
  std::int64_t served_us_ = 0;
  std::int64_t retry_us_ = kRetry_us;  ///< While blocked: how long it waits now,
  std::int64_t retry_at_us_ = 0;       ///< and until when.
  std::uint32_t blocked_count_ = 0;
};

}  // namespace flatpose::can
