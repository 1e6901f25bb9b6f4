#include "flatpose/job/result_board.hpp"

#include <algorithm>
#include <limits>

namespace flatpose::job {
namespace {

constexpr std::int64_t kNever_us = std::numeric_limits<std::int64_t>::max();

}  // namespace

void ResultBoard::clear() noexcept {
  number_ = 0;
  asker_ = kNobody;
  answer_ = Answer::kPending;
  shows_scan_ = false;
  match_ = {};
  further_ = {};
}

void ResultBoard::post(std::uint16_t number, Address asker, const JobRule& rule,
                       Answer answer) noexcept {
  clear();
  number_ = number;
  asker_ = asker;
  rule_ = rule;
  answer_ = answer;
}

void ResultBoard::post_scan(std::uint16_t number, Address asker, const JobRule& rule,
                            const ScanResult& result) noexcept {
  post(number, asker, rule, result.answer);
  scan_ = result;
  scan_rule_ = rule;
  if (!may_have_pose(result.answer)) scan_.match_count = 0;
  shows_scan_ = result.has_scan;
  matches_are_kept_ = scan_.match_count > 0;
  turn_to(0);
}

Answer ResultBoard::post_next(std::uint16_t number, Address asker) noexcept {
  if (!matches_are_kept_) {
    post(number, asker, scan_rule_, Answer::kNoScan);
    return answer_;
  }
  const bool is_last = turned_to_ + 1 >= scan_.match_count;
  post(number, asker, scan_rule_, is_last ? Answer::kNoMatch : scan_.answer);
  shows_scan_ = scan_.has_scan;
  turn_to(std::min(turned_to_ + 1, scan_.match_count));
  return answer_;
}

void ResultBoard::turn_to(int index) noexcept {
  turned_to_ = index;
  match_ = shown(index);
  for (int i = 0; i < kFurtherCount; ++i) further_[i] = shown(index + 1 + i);
}

ShownMatch ResultBoard::shown(int index) const noexcept {
  if (index >= scan_.match_count) return {};
  const FoundMatch& found = scan_.matches[index];
  const Rotation& turn = found.frame_T_pick.rotation;
  const RotationNumbers numbers = rule_.has_reference
                                      ? rotation_numbers(turn, rule_.convention, rule_.reference)
                                      : rotation_numbers(turn, rule_.convention);
  return {static_cast<std::uint16_t>(index + 1),
          found.part,
          found.frame_T_pick.position_mm,
          numbers.value,
          found.score,
          found.visible,
          found.sigma_mm,
          found.sigma_rad,
          found.tool,
          found.pick};
}

bool ResultBoard::is_expired(std::int64_t now_us) const noexcept {
  return has_pose() && rule_.max_age_us > 0 && now_us - scan_.acquired_us > rule_.max_age_us;
}

std::int64_t ResultBoard::expires_us(std::int64_t now_us) const noexcept {
  const bool will_expire = has_pose() && rule_.max_age_us > 0 && !is_expired(now_us);
  return will_expire ? scan_.acquired_us + rule_.max_age_us + 1 : kNever_us;
}

void ResultBoard::show(std::int64_t now_us, Address reader, Snapshot& snapshot) const noexcept {
  snapshot.done_number = number_;
  snapshot.answer = is_expired(now_us) ? Answer::kExpired : answer_;
  snapshot.result_is_readers = number_ != 0 && reader == asker_;
  if (number_ == 0) return;
  snapshot.frame = rule_.frame;
  snapshot.convention = rule_.convention;
  snapshot.job = rule_.job;
  if (!shows_scan_) return;
  snapshot.has_scan = true;
  snapshot.scan_number = scan_.scan_number;
  snapshot.age_ms = held_time((now_us - scan_.acquired_us) / 1000);
  snapshot.sensor_us = scan_.sensor_us;
  snapshot.cycle_us = scan_.cycle_us;
  snapshot.part_hash = scan_.part_hash;
  snapshot.alignment_hash = scan_.alignment_hash;
  snapshot.match_count = static_cast<std::uint16_t>(scan_.match_count);
  if (!is_valid(now_us)) return;
  snapshot.matches_left = static_cast<std::uint16_t>(scan_.match_count - turned_to_ - 1);
  snapshot.match = match_;
  snapshot.further = further_;
}

}  // namespace flatpose::job
