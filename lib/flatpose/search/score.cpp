#include "flatpose/search/score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/edge.hpp"

namespace flatpose::search {
namespace {

// Saturates: a point of a valid template may lie further off than 16 bits of cells reach.
std::int16_t rounded(double value) noexcept {
  constexpr double kMax = 32767.0;
  return static_cast<std::int16_t>(std::clamp(std::floor(value + 0.5), -kMax, kMax));
}

std::int32_t contour_cost(const SearchImages& images, const ProjectedTemplate::Contour& point,
                          int x, int y, std::int32_t place_unit) noexcept {
  const std::int32_t distance = images.edge_cost(point.octant, x, y);
  if (!images.config.use_height) return distance;
  const std::int32_t above = images.height_unit(x, y) - expected_unit(place_unit, point.rise_unit);
  return above > images.surface_cap ? std::min<std::int32_t>(distance, kEdgeCostUnknown) : distance;
}

std::int32_t height_cost(const SearchImages& images, const ProjectedTemplate::Surface& point, int x,
                         int y, std::int32_t place_unit) noexcept {
  const std::int32_t above = images.height_unit(x, y) - expected_unit(place_unit, point.rise_unit);
  if (above > images.surface_cap) return images.surface_cap / 2;
  return std::min(std::abs(above), images.surface_cap);
}

std::int32_t normal_cost(const SearchImages& images, const ProjectedTemplate::Surface& point, int x,
                         int y) noexcept {
  const std::int32_t normal_x_unit = images.normal_x_unit(x, y);
  if (normal_x_unit == kOutsideUnit) return images.surface_cap / 2;
  const std::int32_t off = std::max(std::abs(normal_x_unit - point.normal_x_unit),
                                    std::abs(images.normal_y_unit(x, y) - point.normal_y_unit));
  return std::min(off, images.surface_cap);
}

}  // namespace

ProjectedTemplate project(const model::Template& part, const model::Anchor& anchor, double slope_x,
                          double slope_y, double angle_rad, const SearchImages& images,
                          const ScoreConfig& config) noexcept {
  const Vec3 normal = normalized({-slope_x, -slope_y, 1.0});
  const Rotation work_R_object = tilt_rotation(normal) * rotation_about_z(angle_rad);
  const Vec3 anchor_mm{anchor.x_mm, anchor.y_mm, 0.0};
  const double cell_mm = images.grid.cell_mm;
  const int reach_px = images.lattice.reach_px();

  struct Shift {
    std::int16_t dx;
    std::int16_t dy;
    std::int16_t rise_unit;
    bool within;
  };
  // The height is expected where the cell is, not where the point is.
  const auto shift = [&](double x_mm, double y_mm, double z_mm) {
    const Vec3 offset_mm = work_R_object * (Vec3{x_mm, y_mm, z_mm} - anchor_mm);
    const std::int16_t dx = rounded(offset_mm.x / cell_mm);
    const std::int16_t dy = rounded(offset_mm.y / cell_mm);
    const double rise_mm = offset_mm.z + slope_x * (dx * cell_mm - offset_mm.x) +
                           slope_y * (dy * cell_mm - offset_mm.y);
    return Shift{dx, dy, rounded(rise_mm / images.height_unit_mm),
                 std::abs(dx) <= reach_px && std::abs(dy) <= reach_px};
  };

  ProjectedTemplate projected;
  projected.edge_factor_q8 =
      static_cast<std::int32_t>(std::min(256.0 / normal.z, 1.0 * kEdgeFactorMax_q8));
  const int contour_count = std::min({config.contour_count, kContourCountMax, part.contour_count});
  for (int i = 0; i < contour_count; ++i) {
    const model::ContourPoint& p = part.contour[i];
    const Shift at = shift(p.x_mm, p.y_mm, p.z_mm);
    if (!at.within) continue;
    const Vec3 falling = work_R_object * Vec3{p.nx, p.ny, 0.0};
    projected.contour[projected.contour_count++] = {
        at.dx, at.dy,
        static_cast<std::int16_t>(
            image::octant_of(static_cast<float>(falling.x), static_cast<float>(falling.y))),
        at.rise_unit};
  }
  const int surface_count = std::min({config.surface_count, kSurfaceCountMax, part.surface_count});
  for (int i = 0; i < surface_count; ++i) {
    const model::SurfacePoint& p = part.surface[i];
    const Shift at = shift(p.x_mm, p.y_mm, p.z_mm);
    if (!at.within) continue;
    const double nz = std::sqrt(
        std::max(0.0, 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny));
    const Vec3 turned = work_R_object * Vec3{p.nx, p.ny, nz};
    projected.surface[projected.surface_count++] = {at.dx, at.dy, at.rise_unit,
                                                    normal_unit(turned.x, images.config),
                                                    normal_unit(turned.y, images.config)};
  }
  return projected;
}

std::int32_t cost_max(const SearchImages& images, const ProjectedTemplate& projected) noexcept {
  return ((projected.contour_count * kEdgeCostMax * projected.edge_factor_q8) >> 8) +
         projected.surface_count * images.surface_cap * images.surface_weight;
}

std::int32_t cost(const SearchImages& images, const ProjectedTemplate& projected, int column,
                  int row, std::int32_t place_unit) noexcept {
  std::int32_t surface_sum = 0;
  for (int i = 0; i < projected.surface_count; ++i) {
    const ProjectedTemplate::Surface& p = projected.surface[i];
    const int x = column + p.dx;
    const int y = row + p.dy;
    surface_sum += images.config.use_height ? height_cost(images, p, x, y, place_unit)
                                            : normal_cost(images, p, x, y);
  }
  std::int32_t edge_sum = 0;
  for (int i = 0; i < projected.contour_count; ++i) {
    const ProjectedTemplate::Contour& p = projected.contour[i];
    edge_sum += contour_cost(images, p, column + p.dx, row + p.dy, place_unit);
  }
  const std::int32_t sum =
      surface_sum * images.surface_weight + ((edge_sum * projected.edge_factor_q8) >> 8);
  return std::min(sum, kCostMax);
}

}  // namespace flatpose::search
