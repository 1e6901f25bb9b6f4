#include "port/linux/daemon/job_search.hpp"

#include <algorithm>

#include "port/linux/daemon/plane_check.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;

/// Which of two answers a job of several parts ends with: what ended all comes first, then what was
/// found, with its warning, then why nothing was.
int rank(Answer answer) noexcept {
  switch (answer) {
    case Answer::kCancelled: return 0;
    case Answer::kInternal: return 1;
    case Answer::kBadJob: return 2;
    case Answer::kDeadline: return 3;
    case Answer::kAmbiguous: return 4;
    case Answer::kOk: return 5;
    case Answer::kOutsideLimits: return 6;
    case Answer::kScanPoor: return 7;
    case Answer::kNoMatch: return 8;
    default: return 9;
  }
}

Answer answer_of_fault(Status status) noexcept {
  const bool is_of_job = status == Status::kInvalidArgument || status == Status::kTooLarge;
  return is_of_job ? Answer::kBadJob : Answer::kInternal;
}

/// As the locator orders the matches of one part.
double merit(const locate::Match& match, locate::Order order, const Frames& frames) noexcept {
  switch (order) {
    case locate::Order::kHeight: return (frames.work_T_face() * match.face_T_object.position_mm).z;
    case locate::Order::kVisible: return match.visible;
    case locate::Order::kScore: break;
  }
  return match.score * match.visible;
}

std::uint32_t time_since(std::int64_t start_us, const Host& host) noexcept {
  return job::held_time(host.clock.now_us() - start_us);
}

}  // namespace

bool JobSearch::begin(const job::Order& order, const Host& host) noexcept {
  start_us_ = host.clock.now_us();
  result_ = {};
  result_.answer = Answer::kBadJob;
  job_ = set_->find(order.job);
  if (job_ == nullptr) return false;
  result_.answer = Answer::kPending;
  result_.frame = job_->config.rule.frame;
  result_.alignment_hash = job_->alignment.hash;
  return true;
}

job::ScanResult JobSearch::run(const job::Order& order, const HeldScan& scan,
                               const Host& host) noexcept {
  trace_.clear();
  outside_count_ = 0;
  if (!begin(order, host)) return result_;
  if (!job_->alignment.serves(result_.frame)) {
    result_.answer = Answer::kNoAlignment;
    return result_;
  }
  if (has_moved_[place_of(*job_)]) {
    result_.answer = Answer::kAlignmentMoved;
    return result_;
  }
  frames_ = job_->alignment.frames(result_.frame, scan.up);
  trace_.frames = frames_;
  trace_.face = result_.frame;
  int index = 0;
  for (const int part : job_->config.parts) search_part(part, ++index, order, scan, host);
  if (result_.match_count == 0 && job::may_have_pose(result_.answer))
    result_.answer = without_match();
  if (!job::may_have_pose(result_.answer)) result_.match_count = 0;
  if (result_.match_count > 0) {
    const auto best = static_cast<std::size_t>(result_.matches[0].part - 1);
    result_.part_hash = set_->parts[static_cast<std::size_t>(job_->config.parts[best])].hash;
  }
  result_.cycle_us = time_since(start_us_, host);
  return result_;
}

std::size_t JobSearch::place_of(const Job& job) const noexcept {
  return static_cast<std::size_t>(&job - set_->jobs.data());
}

bool JobSearch::can_verify(const job::Order& order) const noexcept {
  const Job* const job = set_->find(order.job);
  return job != nullptr && job->alignment.work_T_scan.has_value();
}

job::ScanResult JobSearch::verify(const job::Order& order, const HeldScan& scan, Arena arena,
                                  const Host& host, std::string& told) noexcept {
  if (!begin(order, host)) return result_;
  const std::int64_t end_us =
      std::min(order.answer_by_us, start_us_ + job_->config.locate.deadline_us);
  result_.answer = check_plane(*job_, scan, arena, host, end_us, told);
  result_.cycle_us = time_since(start_us_, host);
  if (result_.answer != Answer::kOk && result_.answer != Answer::kAlignmentMoved) return result_;
  for (const Job& other : set_->jobs) {
    if (other.alignment.work_file == job_->alignment.work_file)
      has_moved_[place_of(other)] = result_.answer == Answer::kAlignmentMoved;
  }
  return result_;
}

// A search that was not ended by itself has seen no place empty.
Answer JobSearch::without_match() const noexcept {
  if (result_.answer == Answer::kDeadline) return Answer::kOutOfTime;
  return outside_count_ > 0 ? Answer::kOutsideLimits : Answer::kNoMatch;
}

void JobSearch::search_part(int part, int index, const job::Order& order, const HeldScan& scan,
                            const Host& host) noexcept {
  locate::LocateConfig config = job_->config.locate;
  config.exclusions = job_->config.exclusions;
  const std::int64_t now_us = host.clock.now_us();
  const std::int64_t end_us = std::min(order.answer_by_us, start_us_ + config.deadline_us);
  config.deadline_us = std::max<std::int64_t>(end_us - now_us, 1);
  // What lies outside takes no place from what lies inside.
  if (job_->config.report.limits != PoseLimits{}) config.max_matches = job::kMatchesPerScanMax;
  const Part& searched = set_->parts[static_cast<std::size_t>(part)];
  const Status status = locator_.locate(*searched.model, scan.view, frames_, config, host, *found_);
  Answer answer = answer_of_fault(status);
  if (status == Status::kOk) {
    trace_.add(searched.model, *found_);
    add_matches(searched, index);
    answer = job::answer_of(found_->outcome);
  }
  const bool is_first = result_.answer == Answer::kPending;
  if (is_first || rank(answer) < rank(result_.answer)) result_.answer = answer;
}

void JobSearch::add_matches(const Part& part, int index) noexcept {
  const JobConfig& config = job_->config;
  for (const locate::Match& match : found_->found()) {
    const auto told = report(match, part.model->symmetry, part.picks, config.report, frames_);
    if (!told) {
      ++outside_count_;
      continue;
    }
    add({told->face_T_reported, static_cast<std::uint16_t>(index), match.score, match.visible,
         told->sigma_mm, told->sigma_rad, told->tool, told->pick},
        merit(match, config.locate.order, frames_));
  }
}

// Into its place among those of the parts before; the last fall off.
void JobSearch::add(const job::FoundMatch& added, double merit) noexcept {
  const int count_max = job_->config.locate.max_matches;
  int place = result_.match_count;
  while (place > 0 && merits_[place - 1] < merit) --place;
  if (place >= count_max) return;
  result_.match_count = std::min(result_.match_count + 1, count_max);
  for (int i = result_.match_count - 1; i > place; --i) {
    result_.matches[i] = result_.matches[i - 1];
    merits_[i] = merits_[i - 1];
  }
  result_.matches[place] = added;
  merits_[place] = merit;
}

}  // namespace flatpose::daemon
