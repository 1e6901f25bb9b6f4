#include "port/sim/outline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "flatpose/core/maths.hpp"

namespace flatpose::sim {
namespace {

/// Chords for an arc: a chord over the angle s leaves its circle by r (1 - cos(s / 2)) <= r s^2
/// / 8.
int chord_count(double radius_mm, double angle_rad) {
  const double step_rad = std::sqrt(8.0 * kChordErrorMm / radius_mm);
  return static_cast<int>(std::ceil(std::fabs(angle_rad) / step_rad));
}

/// Appends the arc with both its ends; angles anticlockwise from +x.
void append_arc(Loop& loop, Vec2 center_mm, double radius_mm, double from_rad, double to_rad) {
  const int count = std::max(1, chord_count(radius_mm, to_rad - from_rad));
  for (int i = 0; i <= count; ++i) {
    const auto [s, c] = sin_cos(from_rad + (to_rad - from_rad) * i / count);
    loop.push_back(center_mm + radius_mm * Vec2{c, s});
  }
}

Vec2 unit(Vec2 v) {
  const double length = std::sqrt(v.x * v.x + v.y * v.y);
  if (!(length > 0.0)) throw std::invalid_argument("outline: two corners fall together");
  return (1.0 / length) * v;
}

/// Area and first moments of the triangle fan about the origin.
struct Moments {
  double area = 0.0;
  Vec2 first;
};
Moments moments(const Loop& loop) noexcept {
  Moments sum;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i];
    const Vec2 b = loop[(i + 1) % loop.size()];
    const double area = 0.5 * cross(a, b);
    sum.area += area;
    sum.first = sum.first + (area / 3.0) * (a + b);
  }
  return sum;
}

}  // namespace

Loop circle(Vec2 center_mm, double radius_mm) {
  if (!(radius_mm > 0.0)) throw std::invalid_argument("outline: a circle needs a radius > 0");
  const int count = 12 * std::max(1, (chord_count(radius_mm, 2.0 * kPi) + 11) / 12);
  Loop loop;
  for (int i = 0; i < count; ++i) {
    const auto [s, c] = sin_cos(2.0 * kPi * i / count);
    loop.push_back(center_mm + radius_mm * Vec2{c, s});
  }
  return loop;
}

Loop rounded_polygon(std::span<const Vec2> corners_mm, double radius_mm) {
  if (corners_mm.size() < 3) throw std::invalid_argument("outline: fewer than three corners");
  if (radius_mm <= 0.0) return {corners_mm.begin(), corners_mm.end()};
  Loop loop;
  const std::size_t count = corners_mm.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 corner = corners_mm[i];
    const Vec2 in = unit(corner - corners_mm[(i + count - 1) % count]);
    const Vec2 out = unit(corners_mm[(i + 1) % count] - corner);
    const double turn_rad = arc_tangent(cross(in, out), in.x * out.x + in.y * out.y);
    const auto [s, c] = sin_cos(std::fabs(turn_rad) / 2.0);
    const double side = turn_rad > 0.0 ? 1.0 : -1.0;  // the arc's centre lies to the left of `in`
    const Vec2 start = corner - (radius_mm * s / c) * in;
    const Vec2 center = start + (side * radius_mm) * Vec2{-in.y, in.x};
    const double from_rad = arc_tangent(start.y - center.y, start.x - center.x);
    append_arc(loop, center, radius_mm, from_rad, from_rad + turn_rad);
  }
  return loop;
}

Loop rectangle(Vec2 center_mm, double width_mm, double height_mm, double corner_radius_mm) {
  const double x = width_mm / 2.0;
  const double y = height_mm / 2.0;
  const Vec2 corners[] = {center_mm + Vec2{-x, -y}, center_mm + Vec2{x, -y}, center_mm + Vec2{x, y},
                          center_mm + Vec2{-x, y}};
  return rounded_polygon(corners, corner_radius_mm);
}

Vec2 on_ring(double radius_mm, double angle_rad) {
  const auto [s, c] = sin_cos(angle_rad);
  return {radius_mm * s, radius_mm * c};
}

Loop annular_sector(const AnnularSector& a) {
  const double up_rad = kPi / 2.0;
  const double ro = a.outer_radius_mm;
  const double ri = a.inner_radius_mm;
  Loop loop;
  // A cut corner is the end of the arc and a point of the radial side; without a cut they are one.
  if (a.outer_right_cut_mm > 0.0) {
    loop.push_back(on_ring(ro - a.outer_right_cut_mm, a.half_angle_rad));
  }
  append_arc(loop, {}, ro, up_rad - a.half_angle_rad + a.outer_right_cut_mm / ro,
             up_rad + a.half_angle_rad - a.outer_left_cut_mm / ro);
  if (a.outer_left_cut_mm > 0.0) {
    loop.push_back(on_ring(ro - a.outer_left_cut_mm, -a.half_angle_rad));
  }
  if (a.inner_left_cut_mm > 0.0) {
    loop.push_back(on_ring(ri + a.inner_left_cut_mm, -a.half_angle_rad));
  }
  append_arc(loop, {}, ri, up_rad + a.half_angle_rad - a.inner_left_cut_mm / ri,
             up_rad - a.half_angle_rad + a.inner_right_cut_mm / ri);
  if (a.inner_right_cut_mm > 0.0) {
    loop.push_back(on_ring(ri + a.inner_right_cut_mm, a.half_angle_rad));
  }
  return loop;
}

double signed_area_mm2(const Loop& loop) noexcept { return moments(loop).area; }

double length_mm(const Loop& loop) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 e = loop[(i + 1) % loop.size()] - loop[i];
    sum += std::sqrt(e.x * e.x + e.y * e.y);
  }
  return sum;
}

bool contains(const Loop& loop, Vec2 p) noexcept {
  bool inside = false;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Vec2 a = loop[i];
    const Vec2 b = loop[j];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

double area_mm2(const Outline& outline) noexcept {
  double area = signed_area_mm2(outline.outer);
  for (const Loop& hole : outline.holes) area -= signed_area_mm2(hole);
  return area;
}

Vec2 centroid_mm(const Outline& outline) noexcept {
  Moments sum = moments(outline.outer);
  for (const Loop& hole : outline.holes) {
    const Moments taken = moments(hole);
    sum.area -= taken.area;
    sum.first = sum.first - taken.first;
  }
  return (1.0 / sum.area) * sum.first;
}

double contour_length_mm(const Outline& outline) noexcept {
  double sum = length_mm(outline.outer);
  for (const Loop& hole : outline.holes) sum += length_mm(hole);
  return sum;
}

bool contains(const Outline& outline, Vec2 p_mm) noexcept {
  if (!contains(outline.outer, p_mm)) return false;
  for (const Loop& hole : outline.holes) {
    if (contains(hole, p_mm)) return false;
  }
  return true;
}

void move(Loop& loop, Vec2 offset_mm) noexcept {
  for (Vec2& p : loop) p = p + offset_mm;
}

}  // namespace flatpose::sim
