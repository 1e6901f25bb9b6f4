#pragma once
// A box on a floor, scanned by hand, and the scene that is made of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/canny.hpp"
#include "flatpose/image/dark_pit.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/scene/scene.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"

namespace flatpose::scene {

using rectify::Scan;

/// A box turned about its middle, standing on a floor of any slope.
struct Box {
  double x_mm = 50.0;
  double y_mm = 40.0;
  double length_mm = 44.0;
  double width_mm = 28.0;
  double height_mm = 6.0;
  double angle_rad = 0.0;

  struct Place {
    double along, across;
  };
  [[nodiscard]] Place place(double x, double y) const {
    const double dx = x - x_mm;
    const double dy = y - y_mm;
    return {dx * std::cos(angle_rad) + dy * std::sin(angle_rad),
            -dx * std::sin(angle_rad) + dy * std::cos(angle_rad)};
  }
  /// Distance to the contour, negative inside.
  [[nodiscard]] double beyond_mm(double x, double y) const {
    const Place p = place(x, y);
    const double a = std::fabs(p.along) - length_mm / 2;
    const double b = std::fabs(p.across) - width_mm / 2;
    return std::max(a, b) <= 0.0 ? std::max(a, b) : std::hypot(std::max(a, 0.0), std::max(b, 0.0));
  }
  [[nodiscard]] bool is_near_corner(double x, double y) const {
    const Place p = place(x, y);
    return std::hypot(std::fabs(p.along) - length_mm / 2, std::fabs(p.across) - width_mm / 2) < 4.0;
  }
  /// Outward direction of the side that is nearest.
  [[nodiscard]] Place outward(double x, double y) const {
    const Place p = place(x, y);
    const bool at_end = std::fabs(p.along) - length_mm / 2 > std::fabs(p.across) - width_mm / 2;
    const double u = at_end ? (p.along > 0 ? 1.0 : -1.0) : 0.0;
    const double v = at_end ? 0.0 : (p.across > 0 ? 1.0 : -1.0);
    return {u * std::cos(angle_rad) - v * std::sin(angle_rad),
            u * std::sin(angle_rad) + v * std::cos(angle_rad)};
  }
};

struct Surroundings {
  double pitch_mm = 0.7;
  double noise_mm = 0.0;
  double slope_x = 0.0;
  double slope_y = 0.0;
  double shadow_mm = 0.0;  ///< Lost points beyond the box's +x side.
  unsigned seed = 1;
};

/// 100 mm x 80 mm, seen from above, z up.
inline Scan scan_of(const Box& box, const Surroundings& s) {
  std::mt19937 generator(s.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const int w = static_cast<int>(100.0 / s.pitch_mm);
  const int h = static_cast<int>(80.0 / s.pitch_mm);
  Scan scan(w, h);
  for (int r = 0; r < h; ++r) {
    for (int c = 0; c < w; ++c) {
      const double x = c * s.pitch_mm;
      const double y = r * s.pitch_mm;
      const bool on_box = box.height_mm != 0.0 && box.beyond_mm(x, y) < 0.0;
      const double z = (on_box ? box.height_mm : 0.0) + s.slope_x * x + s.slope_y * y +
                       s.noise_mm * noise(generator);
      scan.set(c, r, {x, y, z});
      const bool in_shadow =
          !on_box && s.shadow_mm > 0.0 && box.beyond_mm(x - s.shadow_mm, y) < 0.0;
      if (in_shadow) scan.lose(c, r);
    }
  }
  return scan;
}

inline constexpr double kCell_mm = 1.0;

/// All of it within the scan.
inline rectify::Grid made_grid() { return {1.5, 1.5, kCell_mm, 96, 76}; }

/// Memory for a scene, of what the rooms say that they take.
inline std::size_t scene_bytes(const Scan& scan, const rectify::Grid& grid) {
  Arena arena = Arena::measuring();
  std::span<image::EdgePoint> edges;
  (void)take_scene(arena, grid, edges);
  const std::size_t kept_bytes = arena.used_bytes();
  for (const auto method : {rectify::Method::kPaint, rectify::Method::kBucket}) {
    (void)arena.take<std::byte>(
        rectify::required_bytes(method, scan.width_px, scan.height_px, grid));
    arena.rewind(kept_bytes);
  }
  image::reserve_fill_scratch(arena, grid.width_px);
  arena.rewind(kept_bytes);
  image::reserve_dark_pit_scratch(arena, grid.width_px, grid.height_px);
  arena.rewind(kept_bytes);
  image::reserve_edge_scratch(arena, grid.width_px, grid.height_px);
  return arena.required_bytes();
}

struct Built {
  rectify::Scratch memory;
  Scene scene;
  Status status;

  Built(const Scan& scan, const SceneConfig& config, const Frames& frames = frames_of_scan(true),
        const rectify::Grid& grid = made_grid())
      : memory(scene_bytes(scan, grid)) {
    status = build_scene(scan.view(), frames, grid, config, memory.arena, scene);
  }
  [[nodiscard]] double x_mm(const image::EdgePoint& e) const { return scene.map.grid.x_of(e.x_px); }
  [[nodiscard]] double y_mm(const image::EdgePoint& e) const { return scene.map.grid.y_of(e.y_px); }
};

inline SceneConfig config_for(const Surroundings& s,
                              rectify::Method method = rectify::Method::kPaint) {
  SceneConfig config;
  config.noise_mm = std::max(0.1, s.noise_mm);
  config.pitch_mm = s.pitch_mm;
  config.method = method;
  return config;
}

}  // namespace flatpose::scene
