#pragma once
// Heartbeats: our own, and watching another's.

#include <cstdint>
#include <limits>

namespace flatpose::can {

inline constexpr std::int64_t kNever_us = std::numeric_limits<std::int64_t>::max();

class HeartbeatProducer {
 public:
  /// The first comes a period from now; 0: none ever.
  void restart(std::uint16_t period_ms, std::int64_t now_us) noexcept {
    period_us_ = std::int64_t{period_ms} * 1000;
    due_us_ = period_us_ == 0 ? kNever_us : now_us + period_us_;
  }
  [[nodiscard]] bool is_due(std::int64_t now_us) const noexcept { return now_us >= due_us_; }
  /// Beats that could not be sent are left out.
  void sent(std::int64_t now_us) noexcept {
    due_us_ += period_us_;
    if (due_us_ <= now_us) due_us_ = now_us + period_us_;
  }
  [[nodiscard]] std::int64_t next_us() const noexcept { return due_us_; }

 private:
  std::int64_t period_us_ = 0;
  std::int64_t due_us_ = kNever_us;
};

/// Watching begins with the first heartbeat, and once lost begins again with the next.
class HeartbeatConsumer {
 public:
  void restart(std::uint8_t node, std::uint16_t limit_ms) noexcept {
    node_ = limit_ms == 0 ? std::uint8_t{0} : node;
    limit_us_ = std::int64_t{limit_ms} * 1000;
    lost_us_ = kNever_us;
  }
  void heard(std::uint8_t node, std::int64_t now_us) noexcept {
    if (node_ != 0 && node == node_) lost_us_ = now_us + limit_us_;
  }
  /// True once for each loss.
  [[nodiscard]] bool take_loss(std::int64_t now_us) noexcept {
    if (now_us < lost_us_) return false;
    lost_us_ = kNever_us;
    return true;
  }
  [[nodiscard]] bool is_watched(std::uint8_t node) const noexcept {
    return node != 0 && node == node_;
  }
  [[nodiscard]] bool is_watching() const noexcept { return lost_us_ != kNever_us; }
  [[nodiscard]] std::int64_t next_us() const noexcept { return lost_us_; }

 private:
  std::uint8_t node_ = 0;
  std::int64_t limit_us_ = 0;
  std::int64_t lost_us_ = kNever_us;
};

}  // namespace flatpose::can
