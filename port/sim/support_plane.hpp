#pragma once
// What a flat face rests on: of all planes that lie on or over a set of points, the one that is
// lowest at the centre of mass. It touches three points whose triangle holds the centre, which is
// what rest on three contacts means.
//
// A linear program in three unknowns (the plane), solved in its dual: weights of the points that
// have the centre as their mean and lift it highest. The simplex method keeps three of them and
// takes in, one at a time, the point that stands out most over their plane.

#include <array>
#include <optional>
#include <span>

#include "flatpose/geometry/vec3.hpp"

namespace flatpose::sim {

struct SupportPlane {
  double height_mm = 0.0;  ///< At the origin.
  double slope_x = 0.0;    ///< z = height_mm + slope_x x + slope_y y
  double slope_y = 0.0;
  std::array<int, 3> touched{};  ///< Indices of points; the origin lies in their triangle.
};

/// The plane over all points that is lowest at x = y = 0.
/// Cost: a pass over the points a pivot, about ten of them.
/// Fails: none when the origin lies outside the points' convex hull (or the pivots reach a limit).
[[nodiscard]] std::optional<SupportPlane> lowest_plane(std::span<const Vec3> points_mm);

}  // namespace flatpose::sim
