#pragma once
// What must never be seen, judged by the trace alone: what went over the wire and when, and when
// the camera took which scan. Knows nothing of the machine.

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "tests/fieldbus/model/block.hpp"

namespace flatpose::model {

/// A scan as the camera took it; its pose on the wire is made from its number.
struct Taken {
  std::int64_t acquired_us = 0;
};

/// A command in the life of a PLC, from the moment it was first sent.
struct Use {
  std::uint16_t number = 0;
  std::uint16_t command = 0;
  std::uint16_t job = 0;
  std::int64_t sent_us = 0;
  bool is_given_up = false;  ///< The PLC goes on without it, and the server has seen that.
  int starts = 0;
  bool was_refused = false;
  bool was_done = false;
};

class Judge {
 public:
  void on_scan(std::uint32_t number, std::int64_t acquired_us) { scans_[number] = {acquired_us}; }

  /// The server took up a request of this use, and set the camera or the search going.
  void on_start(Use& use) {
    if (++use.starts > 1) fail("executed twice");
    if (use.is_given_up) fail("executed after it was given up");
    if (use.was_refused) fail("executed after it was refused");
  }

  /// Any block on its way to any PLC.
  void on_block(const Block& b, std::int64_t now_us, std::int64_t max_age_us) {
    const bool is_done = (bits(b) & kDoneBit) != 0;
    if (done_number(b) != done_number_tail(b)) fail("head is not tail");
    if (is_done != (done_number(b) != 0)) fail("DONE without its number");
    if (is_done && (bits(b) & kBusyBit) != 0) fail("DONE while BUSY");
    if (((bits(b) & kValidBit) != 0) != has_pose(b)) fail("VALID without a pose, or the reverse");
    if (!has_pose(b)) return;
    if (!is_done) fail("a pose without DONE");
    if (static_cast<std::int16_t>(status(b)) < 0) fail("a pose with a negative status");
    judge_pose(b, now_us, max_age_us);
  }

  /// A PLC takes the block for the answer to its command.
  void on_answer(Use& use, const Block& b) {
    use.was_done = true;
    if (use.was_refused) fail("both refused and done");
    if (has_pose(b) && use.command != 1 && use.command != 2 && use.command != 4)
      fail("a pose that was not asked for");
    const bool needs_scan = use.command == 1 || use.command == 3;
    if (static_cast<std::int16_t>(status(b)) < 0 || !needs_scan) return;
    const auto scan = scans_.find(scan_number(b));
    if (scan == scans_.end() || scan->second.acquired_us < use.sent_us) fail("a stale scan");
    if (has_pose(b) && searched_job(b) != use.job) fail("another command's result");
  }

  void on_refusal(Use& use) {
    use.was_refused = true;
    if (use.was_done) fail("both done and refused");
    if (use.starts > 0) fail("refused, though it was started");
  }

  void on_dead_end(const char* where) { fail(std::string("dead end: ") + where); }

  [[nodiscard]] const std::set<std::string>& failures() const { return failures_; }

  /// What the world makes poses from: every number of one match is a function of scan, match, job.
  static std::uint32_t x_of(std::uint32_t scan, int match) {
    return scan * 64U + static_cast<std::uint32_t>(match);
  }
  static std::uint32_t y_of(std::uint32_t scan) { return scan * 7U + 11U; }

 private:
  static std::uint32_t searched_job(const Block& b) { return position_z(b); }

  void judge_pose(const Block& b, std::int64_t now_us, std::int64_t max_age_us) {
    const std::uint32_t scan = scan_number(b);
    const auto taken = scans_.find(scan);
    if (taken == scans_.end()) return fail("a pose of no scan");
    const std::uint32_t x = x_of(scan, match_index(b));
    float x_f = 0;
    const std::uint32_t x_bits = position_x_f(b);
    std::memcpy(&x_f, &x_bits, sizeof x_f);
    const bool is_whole = position_x(b) == x && position_y(b) == y_of(scan) &&
                          x_f == static_cast<float>(x * 0.001) && match_index(b) >= 1 &&
                          match_index(b) <= match_count(b);
    if (!is_whole) fail("a torn pose");
    const std::int64_t age_us = now_us - taken->second.acquired_us;
    if (age_ms(b) != static_cast<std::uint32_t>(age_us / 1000)) fail("a wrong age");
    if (age_us > max_age_us) fail("an expired pose");
  }

  void fail(const std::string& what) { failures_.insert(what); }

  std::map<std::uint32_t, Taken> scans_;
  std::set<std::string> failures_;
};

}  // namespace flatpose::model
