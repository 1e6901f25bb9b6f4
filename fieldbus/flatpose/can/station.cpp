#include "flatpose/can/station.hpp"

namespace flatpose::can {
namespace {

// The machine may be called more than once in a call: its newest order counts. What has a deadline
// counts from the frame's arrival; no scan counts that began before the order is handed over.
void keep(job::Outputs out, std::int64_t now_us, job::Outputs& all) noexcept {
  all.next_us = out.next_us;
  if (out.order.kind == job::Order::Kind::kNone) return;
  out.order.accepted_us = std::max(out.order.accepted_us, now_us);
  all.order = out.order;
}

}  // namespace

job::Outputs Station::serve(std::int64_t now_us) noexcept {
  job::Outputs all;
  bool has_unread = true;
  for (int i = 0; i < kFramesPerTurn; ++i) {
    const Link::Received got = link_.receive();
    if (got.kind == Link::Received::Kind::kNothing) {
      has_unread = false;
      break;
    }
    take_in(got, now_us, all);
    send(now_us);
  }
  if (!has_unread) passed_us_ = std::max(passed_us_, now_us);
  has_more_ = has_unread;
  keep(tell(now_us), now_us, all);
  return all;
}

job::Outputs Station::tell(std::int64_t now_us) noexcept {
  served_us_ = now_us;
  const job::Outputs out = device_.process(passed_us_, {});
  send(now_us);
  return out;
}

void Station::take_in(const Link::Received& got, std::int64_t now_us, job::Outputs& all) noexcept {
  const bool is_known = got.received_us != kNever_us;  // it may have come after `now_us`
  passed_us_ = std::max(passed_us_, is_known ? got.received_us : now_us);
  if (got.kind == Link::Received::Kind::kFrame) {
    keep(device_.process(passed_us_, {.frame = &got.frame}), now_us, all);
    return;
  }
  is_off_ = got.bus.state == BusState::kOff;
  keep(device_.process(passed_us_, {.bus = &got.bus}), now_us, all);
}

// What was blocked goes first. In bus-off nothing does; what waited then is told anew afterwards.
void Station::send(std::int64_t now_us) noexcept {
  if (is_off_) {
    has_waiting_ = is_blocked_ = false;
    return;
  }
  for (int i = 0; i < kSendsPerTurn; ++i) {
    if (!has_waiting_ && !device_.next_frame(now_us, waiting_)) {
      is_blocked_ = false;
      return;
    }
    if (!link_.send(waiting_)) return found_no_room(now_us);
    has_waiting_ = is_blocked_ = false;
  }
  has_more_ = true;
}

// It may be tried before its time, for whatever else this is called for; only what was tried in
// vain at its time waits longer the next time. An FD frame tells its age: it does not wait, but is
// made anew.
void Station::found_no_room(std::int64_t now_us) noexcept {
  if (!is_blocked_) {
    ++blocked_count_;
    is_blocked_ = true;
    retry_us_ = kRetry_us;
    retry_at_us_ = now_us + retry_us_;
  } else if (now_us >= retry_at_us_) {
    retry_us_ = std::min(2 * retry_us_, kRetryMost_us);
    retry_at_us_ = now_us + retry_us_;
  }
  has_waiting_ = !waiting_.is_fd;
  if (waiting_.is_fd) device_.take_back_fd();
}

}  // namespace flatpose::can
