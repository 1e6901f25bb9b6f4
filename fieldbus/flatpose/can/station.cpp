#include "flatpose/can/station.hpp"

namespace flatpose::can {

job::Outputs Station::serve(std::int64_t now_us) noexcept {
  job::Outputs all = device_.process(now_us, {});
  served_us_ = now_us;
  has_more_ = true;
  for (int i = 0; i < kFramesPerTurn; ++i) {
    const Link::Received got = link_.receive();
    if (got.kind == Link::Received::Kind::kNothing) {
      has_more_ = false;
      break;
    }
    const bool is_frame = got.kind == Link::Received::Kind::kFrame;
    const job::Outputs out = is_frame ? device_.process(now_us, {.frame = &got.frame})
                                      : device_.process(now_us, {.bus = &got.bus});
    if (!is_frame) is_off_ = got.bus.state == BusState::kOff;
    all.next_us = out.next_us;
    if (out.order.kind != job::Order::Kind::kNone) all.order = out.order;
    send(now_us);
  }
  send(now_us);
  return all;
}

// What was blocked goes first. In bus-off nothing does; what waited then is told anew afterwards.
void Station::send(std::int64_t now_us) noexcept {
  if (is_off_) {
    has_waiting_ = false;
    return;
  }
  for (int i = 0; i < kFramesPerTurn; ++i) {
    if (!has_waiting_ && !device_.next_frame(now_us, waiting_)) return;
    if (link_.send(waiting_)) {
      has_waiting_ = false;
      retry_us_ = kRetry_us;
      continue;
    }
    if (has_waiting_) {
      retry_us_ = std::min(2 * retry_us_, kRetryMost_us);
    } else {
      ++blocked_count_;
    }
    has_waiting_ = true;
    return;
  }
  has_more_ = true;
}

}  // namespace flatpose::can
