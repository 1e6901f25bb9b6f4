// What the thesis's search reads: floats, tilts of its own, its own pre-computations.

#include <algorithm>
#include <cmath>

#include "bench/speed/ground.hpp"
#include "flatpose/core/maths.hpp"
#include "flatpose/image/normals.hpp"

namespace flatpose::bench {
namespace {

constexpr int kTiltWindow_px = 2;  // the small region that the tilt is the average of
constexpr double kSteepest = 1.0;  // slope
constexpr float kFarFromEdges_px = 100.0F;

thesis::Normal normal_at(const Ground& ground, int x, int y) {
  const float nx = ground.normal_x(x, y);
  const float ny = ground.normal_y(x, y);
  return {nx, ny, image::normal_z(nx, ny), 0.0F};
}

constexpr std::uint16_t kUpright = static_cast<std::uint16_t>(search::kBinCount / 2);

/// The bin of slopes that the normals around a position average to.
std::uint16_t tilt_at(const Ground& ground, int x, int y) {
  const int last = ground.field_px - 1;
  double sum_x = 0.0;
  double sum_y = 0.0;
  double sum_z = 0.0;
  for (int j = -kTiltWindow_px; j <= kTiltWindow_px; ++j) {
    for (int i = -kTiltWindow_px; i <= kTiltWindow_px; ++i) {
      const thesis::Normal n =
          normal_at(ground, std::clamp(x + i, 0, last), std::clamp(y + j, 0, last));
      sum_x += n.x, sum_y += n.y, sum_z += n.z;
    }
  }
  double slope_x = -sum_x / sum_z;
  double slope_y = -sum_y / sum_z;
  const double steepness = std::max(1.0, std::hypot(slope_x, slope_y) / kSteepest);
  const auto bin = [steepness](double slope) {
    return static_cast<int>(std::lround(slope / steepness / search::kSlopeBin)) +
           search::kSlopeBinReach;
  };
  return static_cast<std::uint16_t>(bin(slope_y) * search::kSlopeBinsAcross + bin(slope_x));
}

thesis::Images make_images(const Ground& ground) {
  const int side = ground.images.grid.width_px;
  const int field = ground.field_px;
  thesis::Images images;
  images.width_px = images.height_px = side;
  images.margin_px = ground.images.lattice.reach_px();
  const std::size_t pixel_count =
      static_cast<std::size_t>(images.row_px()) * static_cast<std::size_t>(images.row_px());
  images.chamfer_px.assign(pixel_count, kFarFromEdges_px);
  images.normal.assign(pixel_count, {});
  images.tilt.resize(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  std::vector<std::uint16_t> tilt;
  for (int y = 0; y < field; ++y) {
    for (int x = 0; x < field; ++x)
      tilt.push_back(ground.config.is_level ? kUpright : tilt_at(ground, x, y));
  }
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::size_t to = images.index(x, y);
      images.chamfer_px[to] = ground.chamfer_px(x % field, y % field);
      images.normal[to] = normal_at(ground, x % field, y % field);
      images.tilt[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                  static_cast<std::size_t>(x)] =
          ground.places.is_place(x, y)
              ? tilt[static_cast<std::size_t>(y % field * field + x % field)]
              : thesis::kNoHypothesis;
    }
  }
  return images;
}

thesis::Cloud make_cloud(const Ground& ground) {
  const model::Template& part = *ground.part;
  const model::Anchor& anchor = part.anchors[0];
  const double cell_mm = ground.images.grid.cell_mm;
  const auto in_cells = [cell_mm](float p_mm, float anchor_mm) {
    return static_cast<float>(static_cast<double>(p_mm - anchor_mm) / cell_mm);
  };
  thesis::Cloud cloud;
  for (int i = 0; i < ground.search.score.contour_count; ++i) {
    const model::ContourPoint& p = part.contour[static_cast<std::size_t>(i)];
    cloud.edge.push_back({in_cells(p.x_mm, anchor.x_mm), in_cells(p.y_mm, anchor.y_mm)});
  }
  for (int i = 0; i < ground.search.score.surface_count; ++i) {
    const model::SurfacePoint& p = part.surface[static_cast<std::size_t>(i)];
    cloud.surface.push_back({in_cells(p.x_mm, anchor.x_mm),
                             in_cells(p.y_mm, anchor.y_mm),
                             {p.nx, p.ny, image::normal_z(p.nx, p.ny), 0.0F}});
  }
  return cloud;
}

thesis::Tilt make_tilt(int bin, int angle_count) {
  const Vec3 normal = normalized({-search::slope_x_of_bin(bin), -search::slope_y_of_bin(bin), 1.0});
  thesis::Tilt tilt;
  tilt.cos_tilt = static_cast<float>(normal.z);
  for (int i = 0; i < angle_count; ++i) {
    const Rotation turn = tilt_rotation(normal) * rotation_about_z(2.0 * kPi * i / angle_count);
    thesis::Turn& to = tilt.turns.emplace_back();
    for (std::size_t k = 0; k < 9; ++k) to.m[k] = static_cast<float>(turn.m[k]);
  }
  return tilt;
}

}  // namespace

ThesisGround make_thesis_ground(const Ground& ground) {
  ThesisGround made;
  made.images = make_images(ground);
  made.cloud = make_cloud(ground);
  made.tilts.resize(search::kBinCount);
  for (const std::uint16_t bin : made.images.tilt) {
    if (bin == thesis::kNoHypothesis) continue;
    thesis::Tilt& tilt = made.tilts[bin];
    if (!tilt.turns.empty()) continue;
    tilt = make_tilt(bin, ground.angle_count());
    thesis::make_tables(made.images, made.cloud, tilt);
  }
  return made;
}

}  // namespace flatpose::bench
