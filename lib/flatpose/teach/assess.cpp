#include "flatpose/teach/assess.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/core/sort.hpp"
#include "flatpose/model/normal_spread.hpp"
#include "flatpose/teach/symmetry.hpp"

namespace flatpose::teach {
namespace {

// Bounds of a part's own threshold: a place where a sixth of what the part itself shows is not seen
// is no part, whatever the teach scan held; and a part with a tenth of it spoilt still is one.
constexpr double kThresholdShareMin = 0.83;
constexpr double kThresholdMin = 0.5;  // a part not found in its own scan lets nothing through
constexpr double kThresholdMax = 0.88;
// Scores of like instances differ by less than this; what resembles the part only is farther off.
constexpr double kScoreGap = 0.13;

// The same place, whatever the turn: judged at the contour's middle, which a turn of a nearly
// symmetric part leaves.
bool is_same_place(const model::Template& part, const Pose& a, const Pose& b) noexcept {
  constexpr double kShare = 0.1;
  Vec3 middle_mm;
  for (const model::ContourPoint& p : part.contour_points())
    middle_mm = middle_mm + Vec3{p.x_mm, p.y_mm, p.z_mm};
  middle_mm = (1.0 / std::max(1, part.contour_count)) * middle_mm;
  return norm(a * middle_mm - b * middle_mm) < kShare * part.radius_mm;
}

void flag(model::Template& part, model::Weakness weakness, bool is_weak) noexcept {
  part.weakness =
      is_weak ? part.weakness | weakness : part.weakness & ~static_cast<std::uint32_t>(weakness);
}

// The smallest share of the contour's normals that any direction in the plane has; 0.5 for a
// circle, 0 for parallel lines.
double direction_share(const model::Template& part) noexcept {
  const auto [xx, xy, yy] = model::normal_spread(part);
  const double half_gap = std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
  return (0.5 * (xx + yy) - half_gap) / std::max(1, part.contour_count);
}

// Root mean square lever of the contour about the centre of symmetry, against the part's radius.
double turn_share(const model::Template& part) noexcept {
  const Vec3 c = symmetry_center(part);
  double sum = 0.0;
  for (const model::ContourPoint& p : part.contour_points()) {
    const double lever_mm = (p.x_mm - c.x) * p.ny - (p.y_mm - c.y) * p.nx;
    sum += lever_mm * lever_mm;
  }
  return std::sqrt(sum / std::max(1, part.contour_count)) / part.radius_mm;
}

// Whether a turn by the declared symmetry lays most of the contour onto itself.
bool holds_symmetry(const model::Template& part) noexcept {
  if (part.symmetry.order == 1) return true;
  constexpr double kOverlapMin = 0.8;
  constexpr double kAnyTurn_rad = 1.0;
  const double turn_rad =
      part.symmetry.order == model::kFullSymmetry ? kAnyTurn_rad : 2.0 * kPi / part.symmetry.order;
  return overlap_after_turn(part, part.symmetry.center_x_mm, part.symmetry.center_y_mm, turn_rad,
                            3.0 * part.cell_mm) >= kOverlapMin;
}

}  // namespace

void set_threshold(const locate::LocateResult& everything, const Pose& face_T_object,
                   model::Template& part) noexcept {
  std::array<double, locate::kMatchCountMax + 1> scores{};
  int count = 0;
  part.self_score = 0.0;
  for (const locate::Match& match : everything.found()) {
    if (is_same_place(part, match.face_T_object, face_T_object)) {
      part.self_score = std::max(part.self_score, match.score);
    } else {
      scores[count++] = match.score;
    }
  }
  scores[count++] = everything.rival_score;
  sort_in_place(std::span(scores).first(count), [](double a, double b) { return a > b; });

  // Down from the part's own score over those of its like, to the first gap.
  double lowest_like = part.self_score;
  part.rival_score = 0.0;
  for (int i = 0; i < count; ++i) {
    if (scores[i] < lowest_like - kScoreGap) {
      part.rival_score = scores[i];
      break;
    }
    lowest_like = std::min(lowest_like, scores[i]);
  }
  const double threshold_min =
      std::clamp(kThresholdShareMin * part.self_score, kThresholdMin, kThresholdMax);
  part.score_threshold =
      std::clamp(0.5 * (lowest_like + part.rival_score), threshold_min, kThresholdMax);
  constexpr double kMarginThin = 0.2;
  flag(part, model::kWeakMarginThin, lowest_like - part.rival_score < kMarginThin);
}

void find_weakness(model::Template& part) noexcept {
  constexpr double kDirectionShareMin = 0.06;
  constexpr double kTurnShareMin = 0.04;
  constexpr double kStepOverNoiseMin = 8.0;
  constexpr double kCellsAcrossMin = 16.0;
  const bool is_full = part.symmetry.order == model::kFullSymmetry;
  part.symmetry_likely =
      part.symmetry.order == 1 ? likely_symmetry(part, part.cell_mm) : part.symmetry.order;
  flag(part, model::kWeakSymmetryLikely, part.symmetry_likely != part.symmetry.order);
  flag(part, model::kWeakSymmetryDoubtful, !holds_symmetry(part));
  flag(
      part, model::kWeakDirectionLoose,
      direction_share(part) < kDirectionShareMin || (!is_full && turn_share(part) < kTurnShareMin));
  flag(part, model::kWeakStepNearNoise, part.step_mm < kStepOverNoiseMin * part.noise_mm);
  flag(part, model::kWeakSmall, std::sqrt(part.area_mm2) < kCellsAcrossMin * part.cell_mm);
}

}  // namespace flatpose::teach
