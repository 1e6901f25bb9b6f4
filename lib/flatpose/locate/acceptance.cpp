#include "flatpose/locate/acceptance.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/sigma.hpp"
#include "flatpose/model/equivalents.hpp"

namespace flatpose::locate {
namespace {

// Matches may share this much of their visible surface: what leans on each other, not what lies in
// each other.
constexpr double kClaimedShareMax = 0.3;

}  // namespace

bool Acceptance::is_claimed_near(const Vec3& position_work_mm, int match_count) const noexcept {
  // Cells beyond the contour that a claim marks, or a verification looks at.
  constexpr double kMargin_px = 12.0;
  const double near_mm = 2.0 * part_.radius_mm + kMargin_px * fine_.grid.cell_mm;
  for (int i = match_count; i < result_.match_count; ++i)
    if (norm(accepted_work_mm_[i] - position_work_mm) < near_mm) return true;
  return false;
}

void Acceptance::note_rejected(double score) noexcept {
  result_.best_rejected_score = std::max(result_.best_rejected_score, score);
}

Verdict Acceptance::consider(const refine::PolishResult& polished,
                             const Verification& alone) noexcept {
  const Pose& pose = polished.work_T_object;
  const Verification v = is_claimed_near(pose.position_mm, 0)
                             ? verifier_.verify(fine_, claimed_, pose, settings_.verify)
                             : alone;
  if (v.surface.claimed_count > kClaimedShareMax * v.surface.visible_count) {
    note_rival(v.score, pose);
    return Verdict::kNoMatch;
  }
  const Verdict verdict = judge(polished, v);
  if (verdict != Verdict::kMatch) {
    note_rejected(v.score);
    return verdict;
  }
  accepted_work_mm_[result_.match_count] = pose.position_mm;
  result_.matches[result_.match_count++] = to_match(polished, v);
  claim(part_, fine_, pose, settings_.verify, claimed_);
  return verdict;
}

Verdict Acceptance::judge(const refine::PolishResult& polished,
                          const Verification& v) const noexcept {
  // The confirmed contour may leave a direction open by this share of what the whole one holds.
  constexpr double kHeldMin = 0.005;
  if (v.score < settings_.score_threshold || v.visible < config_.min_visible ||
      !is_allowed(polished.work_T_object)) {
    return Verdict::kNoMatch;
  }
  return v.held >= kHeldMin && v.shows_face ? Verdict::kMatch : Verdict::kGuess;
}

// A second pose in the place of a match that is no equivalent of it.
void Acceptance::note_rival(double score, const Pose& work_T_object) noexcept {
  constexpr double kScoreGap = 0.02;
  constexpr double kAngleGap_rad = 10.0 * kRadPerDeg;
  // The nearest match is the one whose place it takes; seen from there, turned by the symmetry as
  // little as can be.
  Pose match_T_rival;
  int nearest = -1;
  for (int i = 0; i < result_.match_count; ++i) {
    const Pose relative = model::canonical_equivalent(
        result_.matches[i].face_T_object.inverse() * (frames_.face_T_work * work_T_object),
        part_.symmetry);
    if (nearest >= 0 && norm(relative.position_mm) >= norm(match_T_rival.position_mm)) continue;
    match_T_rival = relative;
    nearest = i;
  }
  if (nearest < 0 || norm(match_T_rival.position_mm) >= part_.radius_mm) return;
  if (angle_between_rad(match_T_rival.rotation, Rotation{}) <= kAngleGap_rad) return;
  result_.rival_score = std::max(result_.rival_score, score);
  is_ambiguous_ |= nearest == 0 && score > result_.matches[0].score - kScoreGap;
}

bool Acceptance::is_allowed(const Pose& work_T_object) const noexcept {
  if (arc_cosine(work_T_object.rotation.m[8]) > config_.max_tilt_rad) return false;
  const Vec3 origin_mm = (frames_.face_T_work * work_T_object).position_mm;
  return config_.region.contains(origin_mm.x, origin_mm.y) &&
         settings_.origins.admits(work_T_object.position_mm, 0.0);
}

Match Acceptance::to_match(const refine::PolishResult& polished,
                           const Verification& v) const noexcept {
  Match match;
  match.face_T_object =
      model::canonical_equivalent(frames_.face_T_work * polished.work_T_object, part_.symmetry);
  match.score = v.score;
  match.visible = v.visible;
  match.turn_is_free = polished.turn_is_free;
  match.edge_rms_mm = polished.edge_rms_mm;
  match.surface_rms_mm = polished.surface_rms_mm;
  // Told in the axes of the equivalent that is reported, not of the one that was polished.
  const Pose face_T_polished = frames_.face_T_work * polished.work_T_object;
  const refine::Matrix<6> c =
      refine::covariance_seen_from(refine::Matrix<6>(polished.covariance.data()),
                                   face_T_polished.inverse() * match.face_T_object);
  std::array<double, 36> rows;
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) rows[6 * i + j] = c(i, j);
    for (int j = i; j < 6; ++j) match.covariance[at++] = static_cast<float>(c(i, j));
  }
  const Sigma sigma = sigma_of(match.face_T_object.rotation, rows);
  match.sigma_mm = sigma.mm;
  match.sigma_rad = sigma.rad;
  return match;
}

void Acceptance::sort() noexcept {
  const auto key = [this](const Match& m) {
    switch (config_.order) {
      case Order::kScore: return m.score * m.visible;
      case Order::kHeight: return (frames_.work_T_face() * m.face_T_object.position_mm).z;
      case Order::kVisible: return m.visible;
    }
    return 0.0;
  };
  // Insertion keeps equals in the order they were accepted, and needs no memory.
  for (int i = 1; i < result_.match_count; ++i) {
    const Match match = result_.matches[i];
    int at = i;
    for (; at > 0 && key(match) > key(result_.matches[at - 1]); --at)
      result_.matches[at] = result_.matches[at - 1];
    result_.matches[at] = match;
  }
}

}  // namespace flatpose::locate
