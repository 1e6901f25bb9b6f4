#include "flatpose/teach/assess.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/teach/symmetry.hpp"

namespace flatpose::teach {
namespace {

// Bounds of a part's own threshold: below, a bare plane with a few edges would pass (half of the
// score is the surface's); above, a part with a fifth of its contour touching others would not.
constexpr double kThresholdMin = 0.72;
constexpr double kThresholdMax = 0.90;
// What is worth looking at when scores are compared; a plane without any contour scores about a
// half.
constexpr double kScoreFloor = 0.5;

bool is_near(const Pose& a, const Pose& b, double radius_mm) noexcept {
  return norm(a.position_mm - b.position_mm) < 0.1 * radius_mm;
}

void flag(model::Template& part, model::Weakness weakness, bool is_weak) noexcept {
  part.weakness =
      is_weak ? part.weakness | weakness : part.weakness & ~static_cast<std::uint32_t>(weakness);
}

// The smallest share of the contour's normals that any direction in the plane has; 0.5 for a
// circle, 0 for parallel lines.
double direction_share(const model::Template& part) noexcept {
  double xx = 0, xy = 0, yy = 0;
  for (const model::ContourPoint& p : part.contour_points()) {
    xx += static_cast<double>(p.nx) * p.nx;
    xy += static_cast<double>(p.nx) * p.ny;
    yy += static_cast<double>(p.ny) * p.ny;
  }
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

}  // namespace

void set_threshold(const locate::LocateResult& everything, const Pose& face_T_object,
                   model::Template& part) noexcept {
  std::array<double, locate::kMatchCountMax + 2> scores{};
  int count = 0;
  part.self_score = 0.0;
  for (const locate::Match& match : everything.found()) {
    if (is_near(match.face_T_object, face_T_object, part.radius_mm)) {
      part.self_score = std::max(part.self_score, match.score);
    } else {
      scores[count++] = match.score;
    }
  }
  scores[count++] = everything.rival_score;
  scores[count++] = kScoreFloor;
  std::sort(scores.begin(), scores.begin() + count, [](double a, double b) { return a > b; });

  double upper = part.self_score;
  double widest = 0.0;
  double threshold = kThresholdMin;
  part.rival_score = kScoreFloor;
  for (int i = 0; i < count; ++i) {
    if (scores[i] >= part.self_score || scores[i] < kScoreFloor) continue;
    if (upper - scores[i] > widest) {
      widest = upper - scores[i];
      threshold = 0.5 * (upper + scores[i]);
      part.rival_score = scores[i];
    }
    upper = scores[i];
  }
  part.score_threshold = std::clamp(threshold, kThresholdMin, kThresholdMax);
  constexpr double kMarginThin = 0.1;
  flag(part, model::kWeakMarginThin,
       part.self_score - part.score_threshold < 0.5 * kMarginThin || widest < kMarginThin);
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
  flag(
      part, model::kWeakDirectionLoose,
      direction_share(part) < kDirectionShareMin || (!is_full && turn_share(part) < kTurnShareMin));
  flag(part, model::kWeakStepNearNoise, part.step_mm < kStepOverNoiseMin * part.noise_mm);
  flag(part, model::kWeakSmall, std::sqrt(part.area_mm2) < kCellsAcrossMin * part.cell_mm);
}

}  // namespace flatpose::teach
