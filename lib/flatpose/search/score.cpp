#include "flatpose/search/score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "flatpose/core/maths.hpp"

namespace flatpose::search {
namespace {

// Saturates: a point of a valid template may lie further off than 16 bits of cells reach.
std::int16_t rounded(double value) noexcept {
  constexpr double kMax = 32767.0;
  return static_cast<std::int16_t>(std::clamp(std::floor(value + 0.5), -kMax, kMax));
}

// Half of a maximum: what a point costs that says nothing.
constexpr std::int32_t half(std::int32_t cost_max) noexcept { return (cost_max + 1) / 2; }

std::int32_t contour_cost(const SearchImages& images, const ProjectedTemplate::Contour& point,
                          bool use_directions, const Place& place) noexcept {
  const int x = place.column + point.dx;
  const int y = place.row + point.dy;
  if (!images.missing.contains(x, y)) return half(kEdgeCostMax);
  if (use_directions) return images.edge_cost[point.octant](x, y);
  std::int32_t lowest = kEdgeCostMax;
  for (const auto& channel : images.edge_cost)
    lowest = std::min<std::int32_t>(lowest, channel(x, y));
  return lowest;
}

std::int32_t surface_cost(const SearchImages& images, const ProjectedTemplate::Surface& point,
                          const ScoreScale& scale, const Place& place) noexcept {
  const std::int32_t nothing_known =
      half(kNormalCostMax) + (scale.use_height ? half(kHeightCostMax) : 0);
  const int x = place.column + point.dx;
  const int y = place.row + point.dy;
  if (!images.missing.contains(x, y) || images.missing(x, y) != 0) return nothing_known;

  std::int32_t sum = 0;
  if (scale.use_height) {
    const std::int32_t lift = (place.slope_x_q8 * point.dx + place.slope_y_q8 * point.dy) >> 8;
    const std::int32_t difference =
        images.height_unit(x, y) - (place.height_unit + point.height_unit + lift);
    const std::int32_t steps = (std::abs(difference) * scale.height_factor_q8) >> 8;
    if (difference > 0 && steps >= kHeightCostMax)
      return nothing_known;  // hidden under something higher
    sum += std::min<std::int32_t>(steps, kHeightCostMax);
  }
  const std::int32_t tilt_x =
      images.normal_x_unit(x, y) - (place.normal_x_unit + point.normal_x_unit);
  const std::int32_t tilt_y =
      images.normal_y_unit(x, y) - (place.normal_y_unit + point.normal_y_unit);
  const std::int32_t tilt = std::max(std::abs(tilt_x), std::abs(tilt_y));
  return sum + std::min<std::int32_t>((tilt * scale.normal_factor_q8) >> 8, kNormalCostMax);
}

}  // namespace

ScoreScale score_scale(const ScoreConfig& config) noexcept {
  const double height_tolerance_unit = config.height_tolerance_mm * kHeightUnitsPerMm;
  const double normal_tolerance_unit = config.normal_tolerance_rad * kNormalUnits;
  return {static_cast<std::int32_t>(256.0 * kHeightCostMax / std::max(1.0, height_tolerance_unit)),
          static_cast<std::int32_t>(256.0 * kNormalCostMax / std::max(1.0, normal_tolerance_unit)),
          config.use_height, config.use_directions};
}

ProjectedTemplate project(const model::Template& part, const model::Anchor& anchor, double slope_x,
                          double slope_y, double angle_rad, double cell_mm,
                          const ScoreConfig& config) noexcept {
  const Vec3 normal = normalized({-slope_x, -slope_y, 1.0});
  const Rotation work_R_object = tilt_rotation(normal) * rotation_about_z(angle_rad);
  const Vec3 anchor_mm{anchor.x_mm, anchor.y_mm, 0.0};

  ProjectedTemplate projected;
  projected.edge_factor_q8 = static_cast<std::int32_t>(256.0 / normal.z);
  projected.contour_count =
      std::min({config.contour_count, kSparsePointCountMax, part.contour_count});
  for (int i = 0; i < projected.contour_count; ++i) {
    const model::ContourPoint& p = part.contour[i];
    const Vec3 offset_mm = work_R_object * (Vec3{p.x_mm, p.y_mm, p.z_mm} - anchor_mm);
    const Vec3 falling = work_R_object * Vec3{p.nx, p.ny, 0.0};
    projected.contour[i] = {rounded(offset_mm.x / cell_mm), rounded(offset_mm.y / cell_mm),
                            static_cast<std::int16_t>(image::octant_of(
                                static_cast<float>(falling.x), static_cast<float>(falling.y)))};
  }
  projected.surface_count =
      std::min({config.surface_count, kSparsePointCountMax, part.surface_count});
  for (int i = 0; i < projected.surface_count; ++i) {
    const model::SurfacePoint& p = part.surface[i];
    const Vec3 offset_mm = work_R_object * (Vec3{p.x_mm, p.y_mm, p.z_mm} - anchor_mm);
    const double nz = std::sqrt(
        std::max(0.0, 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny));
    const Vec3 turned = work_R_object * Vec3{p.nx, p.ny, nz};
    projected.surface[i] = {rounded(offset_mm.x / cell_mm), rounded(offset_mm.y / cell_mm),
                            rounded(p.z_mm / normal.z * kHeightUnitsPerMm),
                            rounded((turned.x - normal.x) * kNormalUnits),
                            rounded((turned.y - normal.y) * kNormalUnits)};
  }
  return projected;
}

std::int32_t cost_max(const ProjectedTemplate& projected, const ScoreScale& scale) noexcept {
  const std::int32_t surface_max = kNormalCostMax + (scale.use_height ? kHeightCostMax : 0);
  return ((projected.contour_count * kEdgeCostMax * projected.edge_factor_q8) >> 8) +
         projected.surface_count * surface_max;
}

std::int32_t cost(const SearchImages& images, const ProjectedTemplate& projected,
                  const ScoreScale& scale, const Place& place, std::int32_t limit) noexcept {
  std::int32_t surface_sum = 0;
  for (int i = 0; i < projected.surface_count; ++i) {
    surface_sum += surface_cost(images, projected.surface[i], scale, place);
    if (surface_sum >= limit) return surface_sum;
  }
  std::int32_t edge_sum = 0;
  std::int32_t sum = surface_sum;
  for (int i = 0; i < projected.contour_count; ++i) {
    edge_sum += contour_cost(images, projected.contour[i], scale.use_directions, place);
    sum = surface_sum + ((edge_sum * projected.edge_factor_q8) >> 8);
    if (sum >= limit) return sum;
  }
  return sum;
}

}  // namespace flatpose::search
