#pragma once
// A machine on a desk: two masters, a search and a clock, all in the hands of the test.

#include <gtest/gtest.h>

#include "flatpose/job/machine.hpp"

namespace flatpose::job {

inline constexpr Address kAda = 0xc0000201;
inline constexpr Address kBob = 0xc0000202;
inline constexpr std::int64_t kSecond_us = 1'000'000;

inline JobTable two_jobs() {
  JobTable jobs;
  jobs.count = 2;
  jobs.rules[0] = {.job = 1, .max_age_us = 3 * kSecond_us, .answer_by_us = 2 * kSecond_us};
  jobs.rules[1] = {.job = 7,
                   .frame = FrameName::kRobot,
                   .convention = Convention::kAbbQuaternion,
                   .answer_by_us = 9 * kSecond_us};
  return jobs;
}

class Desk {
 public:
  explicit Desk(const Config& config = {.session_id = 321, .boot_count = 5}) {
    EXPECT_EQ(machine.init(config, two_jobs(), now_us), Status::kOk);
  }

  Outputs process(const Inputs& inputs) {
    out = machine.process(now_us, inputs);
    if (out.order.kind != Order::Kind::kNone) order = out.order;
    EXPECT_GT(out.next_us, now_us);
    return out;
  }
  Outputs pass(std::int64_t us) {
    now_us += us;
    return process({});
  }

  CommandImage image(std::uint16_t number, Command command = Command::kLocate,
                     Address address = kAda) const {
    CommandImage image = machine.image_for({address, 1});
    image.command_number = number;
    image.command = static_cast<std::uint16_t>(command);
    if (command == Command::kReportPick) image.pick_outcome = 1;
    return image;
  }
  Verdict write(const CommandImage& image, Address address = kAda, std::uint64_t connection = 1) {
    const Request request{{address, connection}, true, image, true, false};
    return process({.request = &request}).verdict;
  }
  Verdict write(std::uint16_t number, Command command = Command::kLocate, Address address = kAda) {
    return write(image(number, command, address), address);
  }
  Verdict control(std::uint16_t bits, Address address = kAda) {
    CommandImage image = machine.image_for({address, 1});
    image.control = bits;
    const Request request{{address, 1}, true, image, false, true};
    return process({.request = &request}).verdict;
  }
  void read(Address address = kAda) {
    const Request request{{address, 1}, false, {}, false, false};
    process({.request = &request});
  }

  void tell(SearchEvent::Kind kind, std::uint32_t ticket = 0, const ScanResult& result = {}) {
    const SearchEvent event{kind, ticket, result};
    process({.event = &event});
  }
  void live() {
    tell(SearchEvent::Kind::kSearchAlive);
    tell(SearchEvent::Kind::kSourceAlive);
  }
  /// What a search would say now: `count` matches, told apart by their x.
  ScanResult found(int count = 1, FrameName frame = FrameName::kScan) const {
    ScanResult result;
    result.answer = Answer::kOk;
    result.frame = frame;
    result.scan_number = 1000;
    result.acquired_us = now_us;
    result.has_scan = true;
    result.match_count = count;
    for (int i = 0; i < count; ++i) {
      result.matches[i].frame_T_pick.position_mm = {10.0 * (i + 1), 2, 3};
      result.matches[i].score = 0.9 - 0.01 * i;
      result.matches[i].visible = 0.8;
    }
    return result;
  }
  void finish(const ScanResult& result) {
    tell(SearchEvent::Kind::kFinished, order.ticket, result);
  }

  Snapshot see(Address reader = kAda) const { return machine.snapshot(reader); }
  bool has(Bit bit) const { return (see().bits & bit) != 0; }

  Machine machine;
  std::int64_t now_us = 50 * kSecond_us;
  Outputs out;
  Order order;  ///< The last that was not kNone.
};

}  // namespace flatpose::job
