#pragma once
// Scans of rectangles that lie on a floor at known poses.

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/lib/locate/made_scan.hpp"

namespace flatpose::test {

inline constexpr double kPartWidth_mm = 50.0;
inline constexpr double kPartHeight_mm = 30.0;
inline constexpr double kPartTop_mm = 10.0;

struct Block {
  Pose scan_T_object;
  double width_mm = kPartWidth_mm;
  double height_mm = kPartHeight_mm;
};

/// Height of the top of what lies at a place: blocks reach down to the floor at 0.
inline double bin_height(const std::vector<Block>& blocks, double x, double y) {
  double top_mm = 0.0;
  for (const Block& b : blocks) {
    const Vec3 n = b.scan_T_object.rotation.column(2);
    const Vec3& t = b.scan_T_object.position_mm;
    const double z = t.z - (n.x * (x - t.x) + n.y * (y - t.y)) / n.z;
    const Vec3 p = b.scan_T_object.inverse() * Vec3{x, y, z};
    const bool inside = std::fabs(p.x) <= 0.5 * b.width_mm && std::fabs(p.y) <= 0.5 * b.height_mm;
    if (inside) top_mm = std::max(top_mm, z);
  }
  return top_mm;
}

inline MadeScan bin_scan(const std::vector<Block>& blocks, double noise_mm = 0.05,
                         int width_px = 150, int height_px = 120) {
  return {width_px, height_px, 1.0, [&](double x, double y) { return bin_height(blocks, x, y); },
          noise_mm};
}

/// What is looked for in them.
inline model::Template block_part() {
  model::Template part = rectangle_part(kPartWidth_mm, kPartHeight_mm, kPartTop_mm);
  part.symmetry.order = 2;
  return part;
}

/// Three of the part, apart, at three heights.
inline std::vector<Block> three_blocks() {
  return {{pose_at(35, 30, 10, 0.3)}, {pose_at(110, 35, 22, 1.2)}, {pose_at(50, 85, 16, 2.5)}};
}

}  // namespace flatpose::test
