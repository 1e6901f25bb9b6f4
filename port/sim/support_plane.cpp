#include "port/sim/support_plane.hpp"

#include <cstddef>

namespace flatpose::sim {
namespace {

constexpr int kPivotsMax = 300;
constexpr double kOverMm = 1e-7;    // a point that stands out less is no violation
constexpr double kPivotMin = 1e-9;  // a smaller share would leave three points in a line
constexpr int kNoPoint = -1;

// The three corners to begin with: far out and deep down, so that every point replaces them.
constexpr double kFarMm = 1e4;
constexpr double kDeepMm = -1e6;

double cross_xy(const Vec3& a, const Vec3& b) { return a.x * b.y - a.y * b.x; }

/// Shares of the corners whose mean is p.
std::array<double, 3> shares(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 a = corners[0] - p;
  const Vec3 b = corners[1] - p;
  const Vec3 c = corners[2] - p;
  const double twice_area = cross_xy(corners[1] - corners[0], corners[2] - corners[0]);
  return {cross_xy(b, c) / twice_area, cross_xy(c, a) / twice_area, cross_xy(a, b) / twice_area};
}

SupportPlane plane_through(const std::array<Vec3, 3>& corners) {
  const Vec3 n = cross(corners[1] - corners[0], corners[2] - corners[0]);
  SupportPlane plane;
  plane.slope_x = -n.x / n.z;
  plane.slope_y = -n.y / n.z;
  plane.height_mm = corners[0].z - plane.slope_x * corners[0].x - plane.slope_y * corners[0].y;
  return plane;
}

int highest_over(const SupportPlane& plane, std::span<const Vec3> points_mm) {
  int highest = kNoPoint;
  double over_max_mm = kOverMm;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const Vec3& p = points_mm[i];
    const double over_mm = p.z - plane.height_mm - plane.slope_x * p.x - plane.slope_y * p.y;
    if (over_mm <= over_max_mm) continue;
    over_max_mm = over_mm;
    highest = static_cast<int>(i);
  }
  return highest;
}

/// The corner that `entering` replaces so that the origin stays inside.
int leaving_corner(const std::array<Vec3, 3>& corners, const Vec3& entering) {
  const auto of_origin = shares(corners, {});
  const auto of_entering = shares(corners, entering);
  int leaving = kNoPoint;
  double ratio_min = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (of_entering[k] < kPivotMin) continue;
    const double ratio = of_origin[k] / of_entering[k];
    if (leaving != kNoPoint && ratio >= ratio_min) continue;
    ratio_min = ratio;
    leaving = k;
  }
  return leaving;
}

}  // namespace

std::optional<SupportPlane> lowest_plane(std::span<const Vec3> points_mm) {
  std::array<Vec3, 3> corners{Vec3{-kFarMm, -kFarMm, kDeepMm}, Vec3{kFarMm, -kFarMm, kDeepMm},
                              Vec3{0.0, kFarMm, kDeepMm}};
  std::array<int, 3> touched{kNoPoint, kNoPoint, kNoPoint};
  for (int pivot = 0; pivot < kPivotsMax; ++pivot) {
    SupportPlane plane = plane_through(corners);
    const int entering = highest_over(plane, points_mm);
    if (entering == kNoPoint) {
      for (const int point : touched) {
        if (point == kNoPoint) return std::nullopt;
      }
      plane.touched = touched;
      return plane;
    }
    const int leaving = leaving_corner(corners, points_mm[entering]);
    if (leaving == kNoPoint) return std::nullopt;
    corners[leaving] = points_mm[entering];
    touched[leaving] = entering;
  }
  return std::nullopt;
}

}  // namespace flatpose::sim
