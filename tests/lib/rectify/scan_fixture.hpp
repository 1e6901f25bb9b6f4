#pragma once
// Scans and maps for the tests of this room, with memory of their own.

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "flatpose/core/arena.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/height_map.hpp"

namespace flatpose::rectify {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// An interleaved scan.
struct Scan {
  int width_px, height_px;
  std::vector<float> xyz_mm;

  Scan(int width, int height)
      : width_px(width), height_px(height), xyz_mm(3U * static_cast<std::size_t>(width * height)) {}

  /// Points p_scan_mm = scan_T_work * p_work_mm(column, row).
  Scan(int width, int height, const Pose& scan_T_work,
       const std::function<Vec3(int, int)>& p_work_mm)
      : Scan(width, height) {
    for (int r = 0; r < height; ++r) {
      for (int c = 0; c < width; ++c) set(c, r, scan_T_work * p_work_mm(c, r));
    }
  }

  void set(int column, int row, const Vec3& p_mm) {
    float* const p = &xyz_mm[3U * static_cast<std::size_t>(row * width_px + column)];
    p[0] = static_cast<float>(p_mm.x);
    p[1] = static_cast<float>(p_mm.y);
    p[2] = static_cast<float>(p_mm.z);
  }
  void lose(int column, int row) { set(column, row, {std::nan(""), std::nan(""), std::nan("")}); }
  [[nodiscard]] RangeImageView view() const {
    const float* const p = xyz_mm.data();
    return {p, p + 1, p + 2, width_px, height_px, 12, 12L * width_px};
  }
};

/// A height map, dirty until something clears it.
struct Map {
  std::vector<float> heights_mm;
  std::vector<std::int32_t> sources;
  HeightMap map;

  explicit Map(const Grid& grid)
      : heights_mm(static_cast<std::size_t>(grid.width_px * grid.height_px), 777.0F),
        sources(heights_mm.size(), 777),
        map{grid,
            {heights_mm.data(), grid.width_px, grid.height_px, grid.width_px},
            {sources.data(), grid.width_px, grid.height_px, grid.width_px}} {}

  [[nodiscard]] float height_mm(int column, int row) const { return map.height_mm(column, row); }
  [[nodiscard]] std::int32_t source(int column, int row) const {
    return map.source_index(column, row);
  }
  [[nodiscard]] bool seen(int column, int row) const { return !std::isnan(height_mm(column, row)); }
  [[nodiscard]] int seen_count() const {
    int count = 0;
    for (const float z_mm : heights_mm) count += std::isnan(z_mm) ? 0 : 1;
    return count;
  }
};

/// Scratch of exactly `size_bytes`.
struct Scratch {
  std::vector<std::byte> memory;
  Arena arena;

  explicit Scratch(std::size_t size_bytes) : memory(size_bytes), arena(std::span(memory)) {}
};

/// The pose of a sensor that looks along +z of its scan, onto a work frame whose z points up.
inline Pose looking_down(double distance_mm) {
  return {Rotation{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, {0, 0, distance_mm}};
}

inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

/// Any rotation and a place within some ten millimetres.
inline Pose random_pose(std::mt19937& random, double angle_max_rad) {
  const Vec3 axis =
      normalized({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
  return {rotation_from_vector(uniform(random, -angle_max_rad, angle_max_rad) * axis),
          {uniform(random, -10, 10), uniform(random, -10, 10), uniform(random, -10, 10)}};
}

}  // namespace flatpose::rectify
