#include "flatpose/locate/settings.hpp"

#include <algorithm>
#include <cmath>

namespace flatpose::locate {
namespace {

double bounded(double value, double low, double high) noexcept {
  return std::max(low, std::min(value, high));
}

// How far from an anchor the points of the search lie.
double sparse_reach_mm(const model::Template& part) noexcept {
  const auto contour = part.contour_points();
  const auto surface = part.surface_points();
  const search::ScoreConfig score;
  double squared_mm2 = 0.0;
  const auto include = [&](double x_mm, double y_mm) {
    for (int i = 0; i < part.anchor_count; ++i) {
      const double dx = x_mm - part.anchors[i].x_mm;
      const double dy = y_mm - part.anchors[i].y_mm;
      squared_mm2 = std::max(squared_mm2, dx * dx + dy * dy);
    }
  };
  for (const auto& p : contour.first(std::min<std::size_t>(contour.size(), score.contour_count)))
    include(p.x_mm, p.y_mm);
  for (const auto& p : surface.first(std::min<std::size_t>(surface.size(), score.surface_count)))
    include(p.x_mm, p.y_mm);
  return std::sqrt(squared_mm2);
}

// The window that the tilt is read from fits into every anchor's disc, corners and half a stride
// counted in, and is no wider than noise asks for: a narrow one finds room between what covers the
// part.
int tilt_radius_px(const model::Template& part, double noise_mm, double coarse_mm) noexcept {
  constexpr double kDiscShare = 0.65;
  constexpr double kSlopeSigma = 0.01;
  double clearance_mm = part.anchors[0].clearance_mm;
  for (int i = 1; i < part.anchor_count; ++i)
    clearance_mm = std::min(clearance_mm, static_cast<double>(part.anchors[i].clearance_mm));
  const double widest = std::min(kDiscShare * clearance_mm / coarse_mm + 0.25, 8.0);
  int radius_px = 3;
  for (; radius_px < widest; ++radius_px) {
    const double n = (2.0 * radius_px + 1.0) * (2.0 * radius_px + 1.0);
    const double spread_mm = coarse_mm * std::sqrt(n * radius_px * (radius_px + 1.0) / 3.0);
    if (noise_mm <= kSlopeSigma * spread_mm) break;
  }
  return static_cast<int>(bounded(std::min(1.0 * radius_px, widest), 1.0, 8.0));
}

}  // namespace

Settings derive_settings(const model::Template& part, const LocateConfig& config, double noise_mm,
                         double pitch_mm, double cell_mm) noexcept {
  Settings s;
  const double coarse_mm = 2.0 * cell_mm;
  const double step_mm = std::max(part.step_mm, noise_mm);

  s.scene.noise_mm = noise_mm;
  s.scene.pitch_mm = pitch_mm;
  s.scene.step_mm = part.step_mm;
  s.scene.method = config.method;

  // A surface's height is believed within a few standard deviations and a little slope, but never
  // to half a step.
  const double height_tolerance_mm =
      bounded(3.5 * noise_mm + 0.15 * cell_mm, 0.05 * cell_mm, 0.5 * step_mm);

  // The middle one of nine cells is surer than each of them.
  const double surface_tolerance_mm =
      bounded(2.0 * noise_mm + 0.4 * cell_mm, 0.05 * cell_mm, 0.5 * step_mm);

  // The angle's step lets the farthest point be off by half of what the chamfer images still see
  // (kEdgeCostMax).
  const double reach_mm = search::kEdgeCostMax / 3.0 * coarse_mm;
  s.search.angle_step_rad = bounded(reach_mm / part.radius_mm, 0.02, 0.25);
  // A large part is found from farther off than one cell.
  constexpr double kCellsPerStride = 16.0;
  const double across_px = std::sqrt(part.area_mm2) / coarse_mm;
  s.places.stride_px = static_cast<int>(bounded(across_px / kCellsPerStride, 1.0, 2.0));
  s.places.max_tilt_rad = config.max_tilt_rad;
  s.places.planarity_mm = 2.0 * noise_mm + 0.1 * cell_mm;
  s.search_images.stride_px = s.places.stride_px;
  s.search_images.reach_px = static_cast<int>(sparse_reach_mm(part) / coarse_mm) + 2;
  s.search_images.use_height = config.use_height;
  s.search_images.use_directions = config.use_directions;
  // The tilt read at the anchor is off by some 3 degrees at worst.
  s.search_images.height_tolerance_mm =
      bounded(0.05 * part.radius_mm + 3.0 * noise_mm, height_tolerance_mm,
              std::max(0.9 * step_mm, height_tolerance_mm));

  s.tilt_radius_px = tilt_radius_px(part, noise_mm, coarse_mm);

  s.wide.edge_reach_mm = reach_mm;
  s.wide.height_reach_mm = std::max(2.0 * surface_tolerance_mm, 0.03 * part.radius_mm);
  s.wide.covering_reach_mm = 1.5 * surface_tolerance_mm;
  s.wide.normal_reach = 0.4;
  s.wide.edge_sigma_mm = cell_mm;
  s.wide.height_sigma_mm = std::max(noise_mm, 0.2 * cell_mm);
  s.wide.normal_sigma = bounded(noise_mm / cell_mm, 0.1, 0.5);
  s.narrow = s.wide;
  // From afar a few points are as good as many.
  s.wide.contour_count = 64;
  s.wide.surface_count = 32;
  s.narrow.edge_reach_mm = 4.0 * cell_mm;
  s.narrow.covering_reach_mm = 1.1 * surface_tolerance_mm;
  s.narrow.height_reach_mm = 1.5 * surface_tolerance_mm;

  s.polish.height_tolerance_mm = height_tolerance_mm;
  s.polish.search_mm = 2.5 * cell_mm;

  s.verify.surface_tolerance_mm = surface_tolerance_mm;
  s.verify.height_tolerance_mm = height_tolerance_mm;
  s.screen.surface_tolerance_mm = s.wide.height_reach_mm;
  s.screen.height_tolerance_mm = s.wide.height_reach_mm;
  s.screen.contradiction_weight = 1.0;
  s.screen.use_landmarks = false;
  s.screen.contour_count = 96;
  s.screen.surface_count = 64;
  s.screen.edge_tolerance_px = search::kEdgeCostMax / 3.0;
  s.score_threshold = config.min_score >= 0.0 ? config.min_score : part.score_threshold;
  s.screen.least_score = kHopelessShare * s.score_threshold;
  s.near = s.screen;
  s.near.surface_tolerance_mm = surface_tolerance_mm;
  s.near.height_tolerance_mm = height_tolerance_mm;
  s.near.edge_tolerance_px = s.verify.edge_tolerance_px;
  return s;
}

}  // namespace flatpose::locate
