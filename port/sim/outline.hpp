#pragma once
// What a part looks like from above: closed polygons, an outer one and holes. Arcs become chords
// that leave them by at most kChordErrorMm, far below what a sensor resolves, so that the ray
// casting knows straight edges only and is exact on them.

#include <span>
#include <vector>

namespace flatpose::sim {

inline constexpr double kChordErrorMm = 0.01;

struct Vec2 {
  double x = 0.0;
  double y = 0.0;
  friend Vec2 operator+(Vec2 a, Vec2 b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend Vec2 operator-(Vec2 a, Vec2 b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend Vec2 operator*(double s, Vec2 a) noexcept { return {s * a.x, s * a.y}; }
  friend bool operator==(const Vec2&, const Vec2&) = default;
};
[[nodiscard]] inline double cross(Vec2 a, Vec2 b) noexcept { return a.x * b.y - a.y * b.x; }

/// A closed polygon in mm, anticlockwise; the last point is joined to the first.
using Loop = std::vector<Vec2>;

struct Outline {
  Loop outer;
  std::vector<Loop> holes;  ///< Apart from each other, inside `outer`.
};

/// A circle of 12 n chords, so that it stays what it is when turned by multiples of 30 degrees.
[[nodiscard]] Loop circle(Vec2 center_mm, double radius_mm);
/// The anticlockwise polygon with its convex and concave corners rounded; radius 0 leaves them.
[[nodiscard]] Loop rounded_polygon(std::span<const Vec2> corners_mm, double radius_mm);
[[nodiscard]] Loop rectangle(Vec2 center_mm, double width_mm, double height_mm,
                             double corner_radius_mm = 0.0);

/// Part of a ring about the origin, its middle toward +y. Each corner is cut by a straight line
/// that takes the given length off the arc and off the radial side.
struct AnnularSector {
  double inner_radius_mm;
  double outer_radius_mm;
  double half_angle_rad;
  double outer_right_cut_mm = 0.0;
  double outer_left_cut_mm = 0.0;
  double inner_left_cut_mm = 0.0;
  double inner_right_cut_mm = 0.0;
};
[[nodiscard]] Loop annular_sector(const AnnularSector& shape);
/// The point of that ring at `angle_rad` clockwise from +y.
[[nodiscard]] Vec2 on_ring(double radius_mm, double angle_rad);

/// Positive for an anticlockwise loop.
[[nodiscard]] double signed_area_mm2(const Loop& loop) noexcept;
[[nodiscard]] double length_mm(const Loop& loop) noexcept;
/// Even-odd; of the border, the lower and the left side count as inside.
[[nodiscard]] bool contains(const Loop& loop, Vec2 p_mm) noexcept;

/// Holes taken off.
[[nodiscard]] double area_mm2(const Outline& outline) noexcept;
[[nodiscard]] Vec2 centroid_mm(const Outline& outline) noexcept;
/// Holes counted in.
[[nodiscard]] double contour_length_mm(const Outline& outline) noexcept;
[[nodiscard]] bool contains(const Outline& outline, Vec2 p_mm) noexcept;

void move(Loop& loop, Vec2 offset_mm) noexcept;

}  // namespace flatpose::sim
