#include "flatpose/search/score.hpp"

#include <algorithm>
#include <cstdlib>

#include "flatpose/search/projector.hpp"

namespace flatpose::search {
namespace {

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
  return Projector(part, anchor, images, config, true)
      .at(tilt_of(slope_x, slope_y), rotation_about_z(angle_rad));
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
