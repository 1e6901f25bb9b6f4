#include "flatpose/locate/contest.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/refine/polish.hpp"

namespace flatpose::locate {
namespace {

// Candidates that are refined before it is asked whether there are enough.
constexpr int kRoundCount = 4;
// No polish makes so much of a pose.
constexpr double kPolishGain = 0.3;

PoseSet starts_in(const Workspace& work, const Settings& settings) noexcept {
  // Starts that are no farther apart than the search's steps lead to the same pose.
  const double place_step_mm = settings.places.stride_px * work.coarse.grid.cell_mm;
  return {work.starts, place_step_mm, settings.search.angle_step_rad};
}

}  // namespace

Contest::Contest(const ContestGround& ground, Workspace& work, const Budget& budget,
                 Stopwatch& watch, LocateResult& result) noexcept
    : ground_(ground),
      part_(ground.part),
      settings_(ground.settings),
      work_(work),
      budget_(budget),
      watch_(watch),
      result_(result),
      verifier_(part_),
      refinement_(part_, work.fine, settings_, verifier_),
      acceptance_(part_, ground.frames, ground.config, settings_, verifier_, work.fine,
                  work.claimed, result),
      instances_(work.instances),
      tried_(starts_in(work, settings_)) {}

// In rounds: when enough are beyond doubt, of the rest only those count that may turn out to be
// better in the place of one.
void Contest::enter(std::span<const search::Candidate> candidates) noexcept {
  bool is_enough = false;
  while (!candidates.empty() && !budget_.is_over()) {
    const std::size_t count = std::min<std::size_t>(kRoundCount, candidates.size());
    refine(candidates.first(count), is_enough);
    polish_best();
    is_enough = has_enough();
    candidates = candidates.subspan(count);
  }
}

// What comes to the same pose is kept once.
void Contest::refine(std::span<const search::Candidate> round, bool only_rivals) noexcept {
  std::array<Pose, kRoundCount> starts;
  int count = 0;
  for (const search::Candidate& candidate : round) {
    const Pose& start = candidate.work_T_object;
    // What lies on a part beyond doubt is that part.
    if (is_explained(candidate) || (only_rivals && !is_rival(start)) || tried_.contains(start))
      continue;
    starts[count++] = start;
  }
  std::array<Refined, kRoundCount> refined;
  auto refine_one = [&](int i) { refined[i] = refinement_(starts[i]); };
  if (!for_each_chunk(budget_, count, refine_one)) return;
  const double near_mm = 2.0 * work_.fine.grid.cell_mm;
  for (int i = 0; i < count; ++i) {
    if (!refined[i].is_moved) continue;
    const Pose& pose = refined[i].work_T_object;
    tried_.add(starts[i]);
    if (refined[i].verification.score >= settings_.score_threshold) tried_.add(pose);
    if (refined[i].is_found && !instances_.is_full() &&
        !instances_.contains(pose, near_mm, part_.radius_mm))
      instances_.add(pose, refined[i].verification);
  }
  instances_.sort();
  result_.timings.refine_us += watch_.lap_us();
}

// Whether a start lies in the place of a part beyond doubt.
bool Contest::is_rival(const Pose& start) const noexcept {
  for (int i = 0; i < instances_.count(); ++i) {
    const Instance& instance = instances_[i];
    if (is_beyond_doubt(instance) && is_same_place(instance.work_T_object, start)) return true;
  }
  return false;
}

// The last step for those likely to be asked for: what they are worth on the raw points decides
// over their order.
void Contest::polish_best() noexcept {
  const int wanted = 6 + 2 * ground_.config.max_matches;
  int count = 0;
  for (int i = 0; i < instances_.count() && count < wanted && !budget_.is_over(); ++i) {
    if (has_enough()) break;
    count += polish(instances_[i]) ? 1 : 0;
  }
  instances_.sort();
  result_.timings.verify_us += watch_.lap_us();
}

bool Contest::is_beyond_doubt(const Instance& instance) const noexcept {
  constexpr double kShare = 0.95;
  // One that is hardly visible enough does not end the search: a better one may lie in the open.
  constexpr double kVisibleMargin = 0.05;
  return instance.is_polished && instance.verification.score >= kShare * part_.self_score &&
         instance.verification.visible >= ground_.config.min_visible + kVisibleMargin &&
         acceptance_.judge(instance.polished, instance.verification) == Verdict::kMatch;
}

bool Contest::has_enough() const noexcept {
  int count = 0;
  for (int i = 0; i < instances_.count(); ++i) {
    if (!is_beyond_doubt(instances_[i])) continue;
    bool is_new = true;
    for (int j = 0; j < i && is_new; ++j)
      is_new = !is_same_place(instances_[j].work_T_object, instances_[i].work_T_object);
    count += is_new ? 1 : 0;
  }
  return count >= ground_.config.max_matches;
}

// Whether the candidate's anchor stands on the surface of a part that an earlier anchor has found
// beyond doubt. (Poses from one anchor compete: a turned part stands in its own place.)
bool Contest::is_explained(const search::Candidate& candidate) const noexcept {
  if (candidate.anchor == 0) return false;
  const model::Anchor& anchor = part_.anchors[candidate.anchor];
  const Vec3 p_work_mm = candidate.work_T_object * Vec3{anchor.x_mm, anchor.y_mm, 0.0};
  for (int i = 0; i < instances_.count(); ++i) {
    const Instance& instance = instances_[i];
    if (is_beyond_doubt(instance) &&
        is_on_surface(instance.polished.work_T_object.inverse() * p_work_mm)) {
      return true;
    }
  }
  return false;
}

bool Contest::is_on_surface(const Vec3& p_object_mm) const noexcept {
  const double spacing_mm = std::sqrt(part_.area_mm2 / std::max(1, part_.surface_count));
  for (const model::SurfacePoint& p : part_.surface_points()) {
    const Vec3 apart = p_object_mm - Vec3{p.x_mm, p.y_mm, p.z_mm};
    if (std::fabs(apart.x) <= spacing_mm && std::fabs(apart.y) <= spacing_mm &&
        std::fabs(apart.z) <= settings_.verify.surface_tolerance_mm) {
      return true;
    }
  }
  return false;
}

// Best first. A match explains why the contour of a part that adjoins it cannot be seen there, so
// those left are looked at again while there are new ones.
void Contest::accept() noexcept {
  constexpr int kRoundsMax = kMatchCountMax;
  bool has_new = true;
  for (int round = 0; has_new && round < kRoundsMax; ++round) {
    has_new = false;
    for (int i = 0; i < instances_.count() && !acceptance_.is_full() && !budget_.is_over(); ++i)
      has_new |= consider(i);
  }
  if (budget_.was_over()) accept_polished();
  acceptance_.sort();
  result_.timings.verify_us += watch_.lap_us();
}

// What is known when time is up: a verdict on each that was polished in time, and on so many only
// that the end is not put off by much.
void Contest::accept_polished() noexcept {
  int verdicts_left = ground_.config.max_matches + kRoundCount;
  for (int i = 0; i < instances_.count() && verdicts_left > 0 && !acceptance_.is_full(); ++i) {
    Instance& instance = instances_[i];
    if (!instance.is_polished || !instance.is_open || !has_news(instance)) continue;
    (void)decide(instance);
    --verdicts_left;
  }
}

// Of the poses in the place of the next, the one that is best on the raw points: a part that is
// nearly symmetric is often told from its turned self by these alone. Returns whether there is a
// new match.
bool Contest::consider(int index) noexcept {
  if (!polish(instances_[index])) return false;
  int best = index;
  for (int i = index + 1; i < instances_.count(); ++i) {
    if (is_same_place(instances_[i].work_T_object, instances_[index].work_T_object) &&
        instances_[i].rank() + kPolishGain > instances_[best].rank() && polish(instances_[i]) &&
        instances_[i].rank() > instances_[best].rank()) {
      best = i;
    }
  }
  bool has_new = false;
  for (const int i : {best, index}) {
    Instance& instance = instances_[i];
    if (!instance.is_open || !has_news(instance)) continue;
    const Verdict verdict = decide(instance);
    has_new |= verdict == Verdict::kMatch;
    if (verdict == Verdict::kGuess) break;
  }
  return has_new;
}

Verdict Contest::decide(Instance& instance) noexcept {
  instance.judged_at = result_.match_count;
  const Verdict verdict = acceptance_.consider(instance.polished, instance.verification);
  if (verdict == Verdict::kGuess) close_place_of(instance);
  if (verdict == Verdict::kMatch) instance.is_open = false;
  return verdict;
}

// Whether a verdict on it may be another than last time.
bool Contest::has_news(const Instance& instance) const noexcept {
  return instance.judged_at < 0 ||
         acceptance_.is_claimed_near(instance.polished.work_T_object.position_mm,
                                     instance.judged_at);
}

// Where the best that fits is a guess, what fits less is none the better.
void Contest::close_place_of(const Instance& guess) noexcept {
  const double rank = guess.rank();
  for (int i = 0; i < instances_.count(); ++i) {
    Instance& instance = instances_[i];
    if (instance.rank() <= rank && is_same_place(instance.work_T_object, guess.work_T_object))
      instance.is_open = false;
  }
}

bool Contest::is_same_place(const Pose& a, const Pose& b) const noexcept {
  constexpr double kShare = 0.3;
  return norm(a.position_mm - b.position_mm) < kShare * part_.radius_mm;
}

// The last step on the raw points. Returns whether the instance is still in question; it is
// polished then.
bool Contest::polish(Instance& instance) noexcept {
  if (!instance.is_open || instance.is_polished) return instance.is_open;
  instance.is_open = instance.verification.score >= kHopelessShare * settings_.score_threshold;
  if (!instance.is_open) {
    acceptance_.note_rejected(instance.verification.score);
    return false;
  }
  const Result<refine::PolishResult> polished = refine::polish(
      part_, ground_.raw, instance.work_T_object, settings_.polish, work_.polish, budget_);
  instance.is_open = polished.status() == Status::kOk;
  if (!instance.is_open) return false;
  instance.polished = *polished;
  instance.is_polished = true;
  instance.verification =
      verifier_.verify(work_.fine, {}, polished->work_T_object, settings_.verify);
  return true;
}

}  // namespace flatpose::locate
