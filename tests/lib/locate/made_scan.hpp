#pragma once
// Scans, scenes and templates made by hand for the tests of refine, locate and teach: every height
// and every contour is known exactly.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/maths.hpp"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/image/canny.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/rectify/rectify.hpp"
#include "flatpose/refine/fine_images.hpp"
#include "flatpose/refine/raw_scan.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::test {

inline constexpr double kLost = std::numeric_limits<double>::quiet_NaN();

/// Height over a place; kLost where nothing is seen.
using HeightOf = std::function<double(double x_mm, double y_mm)>;

/// A scan of points on a regular grid, columns along x, rows along y, the first at (0, 0).
struct MadeScan {
  int width_px = 0;
  int height_px = 0;
  double pitch_mm = 1.0;
  std::vector<float> xyz_mm;

  MadeScan(int width, int height, double pitch, const HeightOf& height_of, double noise_mm = 0.0,
           unsigned seed = 1)
      : width_px(width), height_px(height), pitch_mm(pitch) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const double x = column * pitch;
        const double y = row * pitch;
        const double z = height_of(x, y) + (noise_mm > 0.0 ? noise_mm * noise(generator) : 0.0);
        const bool lost = std::isnan(z);
        for (const double v : {x, y, z}) xyz_mm.push_back(static_cast<float>(lost ? kLost : v));
      }
    }
  }
  [[nodiscard]] RangeImageView view() const {
    const float* const p = xyz_mm.data();
    return {p, p + 1, p + 2, width_px, height_px, 12, 12L * width_px};
  }
  float* at(int column, int row) {
    return &xyz_mm[3U * static_cast<std::size_t>(row * width_px + column)];
  }
  /// A grid whose cells lie on the points.
  [[nodiscard]] rectify::Grid grid() const { return {0.0, 0.0, pitch_mm, width_px, height_px}; }
};

/// The scene and the fine images of a made scan, cell by point.
struct MadeScene {
  std::vector<std::byte> memory;
  Arena arena;
  scene::Scene scene;
  refine::FineImages fine;

  explicit MadeScene(const MadeScan& scan, double noise_mm = 0.1)
      : MadeScene(scan.view(), scan.grid(), scan.pitch_mm, noise_mm) {}
  MadeScene(const RangeImageView& scan, const rectify::Grid& grid, double pitch_mm,
            double noise_mm) {
    Arena measuring = Arena::measuring();
    std::span<image::EdgePoint> edges;
    (void)scene::take_scene(measuring, grid, edges);
    (void)refine::take_fine_images(measuring, grid);
    image::reserve_fill_scratch(measuring, grid.width_px);
    image::reserve_edge_scratch(measuring, grid.width_px, grid.height_px);
    (void)measuring.take<std::byte>(
        rectify::required_bytes(rectify::Method::kPaint, scan.width_px, scan.height_px, grid));
    memory.resize(measuring.required_bytes());
    arena = Arena(std::span(memory));
    scene::SceneConfig config;
    config.noise_mm = noise_mm;
    config.pitch_mm = pitch_mm;
    EXPECT_EQ(scene::build_scene(scan, {}, grid, config, arena, scene), Status::kOk);
    fine = refine::take_fine_images(arena, grid);
    EXPECT_EQ(refine::build_fine_images(scene, fine), Status::kOk);
  }
  MadeScene(const MadeScene&) = delete;
  MadeScene& operator=(const MadeScene&) = delete;
};

inline Pose pose_at(double x_mm, double y_mm, double z_mm, double turn_rad = 0.0) {
  return {rotation_about_z(turn_rad), {x_mm, y_mm, z_mm}};
}

/// Whether a place lies on a rectangle about the origin of a pose that turns about z only.
inline bool on_rectangle(const Pose& work_T_object, double width_mm, double height_mm, double x_mm,
                         double y_mm) {
  const Vec3 p = work_T_object.inverse() * Vec3{x_mm, y_mm, work_T_object.position_mm.z};
  return std::fabs(p.x) <= 0.5 * width_mm && std::fabs(p.y) <= 0.5 * height_mm;
}

inline model::ContourPoint contour_point(double x_mm, double y_mm, double nx, double ny,
                                         double step_mm) {
  model::ContourPoint p;
  p.x_mm = static_cast<float>(x_mm);
  p.y_mm = static_cast<float>(y_mm);
  p.nx = static_cast<float>(nx);
  p.ny = static_cast<float>(ny);
  p.step_mm = static_cast<float>(step_mm);
  p.spread_mm = 0.1F;
  return p;
}

/// Sets what every template of a part about the origin needs besides its clouds.
inline void finish(model::Template& part, double area_mm2, double radius_mm, double clearance_mm,
                   double step_mm) {
  part.cell_mm = part.pitch_mm = 1.0;
  part.noise_mm = 0.1;
  part.step_mm = step_mm;
  part.area_mm2 = area_mm2;
  part.radius_mm = radius_mm;
  part.score_threshold = 0.8;
  part.anchor_count = 1;
  part.anchors[0] = {0.0F, 0.0F, static_cast<float>(clearance_mm)};
  std::mt19937 generator(7);  // any prefix shall be spread about evenly
  std::shuffle(part.contour.begin(), part.contour.begin() + part.contour_count, generator);
  std::shuffle(part.surface.begin(), part.surface.begin() + part.surface_count, generator);
}

/// A flat rectangle about the origin: contour points every `spacing_mm`, none at the corners.
inline model::Template rectangle_part(double width_mm, double height_mm, double step_mm,
                                      double spacing_mm = 2.0) {
  model::Template part;
  const double half_x = 0.5 * width_mm;
  const double half_y = 0.5 * height_mm;
  const auto add = [&](double x, double y, double nx, double ny) {
    part.contour[part.contour_count++] = contour_point(x, y, nx, ny, step_mm);
  };
  for (double x = -half_x + spacing_mm; x <= half_x - spacing_mm; x += spacing_mm) {
    add(x, half_y, 0, 1);
    add(x, -half_y, 0, -1);
  }
  for (double y = -half_y + spacing_mm; y <= half_y - spacing_mm; y += spacing_mm) {
    add(half_x, y, 1, 0);
    add(-half_x, y, -1, 0);
  }
  const double apart_mm = std::sqrt(width_mm * height_mm / 200.0);
  for (double y = -half_y + 3.0; y <= half_y - 3.0; y += apart_mm) {
    for (double x = -half_x + 3.0; x <= half_x - 3.0; x += apart_mm) {
      part.surface[part.surface_count++] = {static_cast<float>(x), static_cast<float>(y), 0, 0, 0};
    }
  }
  finish(part, width_mm * height_mm, std::sqrt(half_x * half_x + half_y * half_y),
         std::min(half_x, half_y), step_mm);
  return part;
}

/// A flat disc about the origin.
inline model::Template disc_part(double radius_mm, double step_mm, int contour_count = 120) {
  model::Template part;
  for (int i = 0; i < contour_count; ++i) {
    const double a = 2.0 * kPi * i / contour_count;
    part.contour[part.contour_count++] = contour_point(
        radius_mm * std::cos(a), radius_mm * std::sin(a), std::cos(a), std::sin(a), step_mm);
  }
  const double apart_mm = radius_mm * std::sqrt(kPi / 200.0);
  for (double y = -radius_mm; y <= radius_mm; y += apart_mm) {
    for (double x = -radius_mm; x <= radius_mm; x += apart_mm) {
      if (x * x + y * y > (radius_mm - 3.0) * (radius_mm - 3.0)) continue;
      part.surface[part.surface_count++] = {static_cast<float>(x), static_cast<float>(y), 0, 0, 0};
    }
  }
  part.symmetry.order = model::kFullSymmetry;
  finish(part, kPi * radius_mm * radius_mm, radius_mm, radius_mm, step_mm);
  return part;
}

}  // namespace flatpose::test
