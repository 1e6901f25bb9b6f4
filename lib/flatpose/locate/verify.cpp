#include "flatpose/locate/verify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flatpose/locate/landmark_tally.hpp"
#include "flatpose/locate/sight.hpp"

namespace flatpose::locate {
namespace {

bool is_claimed(const refine::FineImages& images, ImageView<const std::uint8_t> claimed,
                const Vec3& p_mm) noexcept {
  if (claimed.empty()) return false;
  const Cell cell = cell_at(images.grid, p_mm.x, p_mm.y);
  return claimed.contains(cell.column, cell.row) && claimed(cell.column, cell.row) != 0;
}

// How far off the nearest edge is that falls the right way.
double edge_distance_px(const refine::FineImages& images, const Vec3& p_mm,
                        const Vec3& falling) noexcept {
  const Cell cell = cell_at(images.grid, p_mm.x, p_mm.y);
  if (!images.height_mm.contains(cell.column, cell.row))
    return std::numeric_limits<double>::infinity();
  const int octant = image::octant_of(static_cast<float>(falling.x), static_cast<float>(falling.y));
  return images.edge_distance_third_px[octant](cell.column, cell.row) / 3.0;
}

// How well an edge so far off agrees with a contour point: 1 within the tolerance, then less and
// less, 0 beyond kFadeShare tolerances. A hard bound would let a fraction of a cell decide.
double edge_agreement(double distance_px, double tolerance_px) noexcept {
  constexpr double kFadeShare = 2.4;
  return std::clamp((kFadeShare - distance_px / tolerance_px) / (kFadeShare - 1.0), 0.0, 1.0);
}

// Where the contour is to be seen from: a little inside it the surface, a little outside something
// lower.
constexpr double kProbe_px = 2.5;
constexpr double kWallShare = 0.75;

PointVerdict judge_contour(const refine::FineImages& images, ImageView<const std::uint8_t> claimed,
                           const Vec3& p_mm, const Vec3& falling, const Vec3& probe_mm,
                           double edge_tolerance_px, const VerifyConfig& config) noexcept {
  // What hides the contour covers most of the cells beside it; what confirms it may be one of them.
  const auto look_at = [&](const Vec3& beside_mm) {
    return look(images, beside_mm, config.surface_tolerance_mm, config.height_tolerance_mm);
  };
  const auto is_hidden = [](const Look& seen) {
    return seen.middle == Sight::kAbove || seen.nearest == Sight::kAbove;
  };
  const Look look_inside = look_at(p_mm - probe_mm);
  if (is_hidden(look_inside)) return {};
  const Look look_outside = look_at(p_mm + probe_mm);
  if (is_hidden(look_outside)) return {};
  const Sight inside = look_inside.nearest;
  const Sight outside = look_outside.nearest;
  if (inside == Sight::kNothing) return {};
  const double distance_px = edge_distance_px(images, p_mm, falling);
  const double agreement = edge_agreement(distance_px, edge_tolerance_px);
  // Another part adjoins here, and where two touch at one height there is no edge.
  if (agreement < 1.0 && is_claimed(images, claimed, p_mm + probe_mm)) return {};
  if (outside == Sight::kNothing && agreement == 0.0) return {};  // the scan ends or is dark here
  if (inside != Sight::kAt) return {true};
  return {true, agreement, distance_px};
}

double share(double confirmed, double visible) noexcept {
  return visible > 0.0 ? confirmed / visible : 0.0;
}

// Noise does not open a surface: what is missing of it is a hole or an end that the part does not
// have, small as it may be beside the rest.
double surface_agreement(double confirmed_share, double contradiction_weight) noexcept {
  return std::max(0.0, 1.0 - contradiction_weight * (1.0 - confirmed_share));
}

// Which side of a step the sensor draws as a ramp turns with the part, so no point is more certain
// than the contour typically is: the middle one of its spreads.
double typical_spread_mm(const model::Template& part) noexcept {
  std::array<float, model::kContourPointCountMax> spread_mm{};
  int count = 0;
  for (const model::ContourPoint& p : part.contour_points()) {
    if (p.spread_mm >= 0.0F) spread_mm[count++] = p.spread_mm;
  }
  if (count == 0) return 0.0;
  const auto middle = spread_mm.begin() + count / 2;
  std::nth_element(spread_mm.begin(), middle, spread_mm.begin() + count);
  return static_cast<double>(*middle);
}

// What the surface says.
struct SurfaceVerdict {
  Evidence evidence;
  double visible_share = 0.0;    // of the area
  double confirmed_share = 0.0;  // of what is visible
};

SurfaceVerdict judge_surface(const model::Template& part, const refine::FineImages& images,
                             ImageView<const std::uint8_t> claimed, const Pose& work_T_object,
                             const VerifyConfig& config) noexcept {
  SurfaceVerdict out;
  double area = 0.0;
  double visible_area = 0.0;
  double confirmed_area = 0.0;
  const auto points = part.surface_points();
  for (const model::SurfacePoint& p :
       points.first(std::min<std::size_t>(points.size(), config.surface_count))) {
    const double weight = p.weight;
    area += weight;
    const Vec3 q_mm = work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm};
    const Sight seen =
        look(images, q_mm, config.surface_tolerance_mm, config.height_tolerance_mm).middle;
    if (seen == Sight::kNothing || seen == Sight::kAbove) continue;
    ++out.evidence.visible_count;
    visible_area += weight;
    if (is_claimed(images, claimed, q_mm)) ++out.evidence.claimed_count;
    if (seen != Sight::kAt) continue;
    ++out.evidence.confirmed_count;
    confirmed_area += weight;
  }
  out.visible_share = share(visible_area, area);
  out.confirmed_share = share(confirmed_area, visible_area);
  return out;
}

}  // namespace

Verifier::Verifier(const model::Template& part) noexcept
    : part_(part), weight_(part), typical_spread_mm_(typical_spread_mm(part)), hold_(part) {
  for (int i = 0; i < part.contour_count; ++i)
    weight_before_[i + 1] = weight_before_[i] + weight_(part.contour[i]);
}

Verification Verifier::verify(const refine::FineImages& images,
                              ImageView<const std::uint8_t> claimed, const Pose& work_T_object,
                              const VerifyConfig& config) const noexcept {
  const double probe_mm = kProbe_px * images.grid.cell_mm;
  const auto judge = [&](const model::ContourPoint& p) {
    const Vec3 q_mm = work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm};
    const Vec3 falling = work_T_object.rotation * Vec3{p.nx, p.ny, 0.0};
    // A side wall that leans toward the sensor draws the fall out over its own width, and where the
    // teach scan saw a ramp the place is as uncertain as that was.
    double edge_tolerance_px = config.edge_tolerance_px;
    edge_tolerance_px +=
        std::max(typical_spread_mm_, static_cast<double>(p.spread_mm)) / images.grid.cell_mm;
    edge_tolerance_px += kWallShare * std::max(0.0, falling.z) * p.step_mm / images.grid.cell_mm;
    return judge_contour(images, claimed, q_mm, falling, probe_mm * falling, edge_tolerance_px,
                         config);
  };

  const SurfaceVerdict surface = judge_surface(part_, images, claimed, work_T_object, config);
  Verification out;
  out.surface = surface.evidence;
  out.visible = surface.visible_share;
  const double surface_score =
      surface_agreement(surface.confirmed_share, config.contradiction_weight);
  if (surface_score < config.least_score) return out;
  double visible_weight = 0.0;
  double confirmed_weight = 0.0;
  LandmarkTally landmarks(part_.landmarks);
  Hold hold = config.use_landmarks ? hold_ : Hold();
  const int contour_count = std::min(part_.contour_count, config.contour_count);
  for (int i = 0; i < contour_count; ++i) {
    // At best all that is left is seen and confirmed.
    const double left = weight_before_[contour_count] - weight_before_[i];
    if (surface_score * share(confirmed_weight + left, visible_weight + left) < config.least_score)
      return out;
    const model::ContourPoint& p = part_.contour[i];
    const PointVerdict verdict = judge(p);
    if (!verdict.seen) continue;
    ++out.contour.visible_count;
    visible_weight += weight_(p);
    if (verdict.agreement > 0.5) ++out.contour.confirmed_count;
    confirmed_weight += verdict.agreement * weight_(p);
    if (!config.use_landmarks) continue;
    landmarks.add(i, verdict);
    hold.add(p, verdict.agreement);
  }
  for (int i = 0; config.use_landmarks && i < part_.landmarks.mirrored_count; ++i) {
    const PointVerdict verdict = judge(part_.landmarks.mirrored[i]);
    if (verdict.seen) landmarks.add_mirrored(i, verdict);
  }
  out.score = surface_score * share(confirmed_weight, visible_weight) * landmarks.agreement();
  out.held = hold.least_share();
  out.shows_face = landmarks.shows_face(part_.contour_count);
  return out;
}

void claim(const model::Template& part, const refine::FineImages& images, const Pose& work_T_object,
           const VerifyConfig& config, ImageView<std::uint8_t> claimed) noexcept {
  const double spacing_mm = std::sqrt(part.area_mm2 / std::max(1, part.surface_count));
  const int reach_px = static_cast<int>(0.75 * spacing_mm / images.grid.cell_mm) + 1;
  for (const model::SurfacePoint& p : part.surface_points()) {
    const Vec3 q_mm = work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm};
    if (look(images, q_mm, config.surface_tolerance_mm, config.height_tolerance_mm).nearest !=
        Sight::kAt) {
      continue;
    }
    const Cell centre = cell_at(images.grid, q_mm.x, q_mm.y);
    for (int row = centre.row - reach_px; row <= centre.row + reach_px; ++row) {
      for (int column = centre.column - reach_px; column <= centre.column + reach_px; ++column) {
        if (claimed.contains(column, row)) claimed(column, row) = 1;
      }
    }
  }
}

}  // namespace flatpose::locate
