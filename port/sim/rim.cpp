#include "port/sim/rim.hpp"

#include <algorithm>
#include <cmath>

namespace flatpose::sim {
namespace {

/// Calls visit(point, unit vector along the edge) along the loop.
template <class Visit>
void walk(const Loop& loop, Visit visit) {
  double left_mm = 0.0;  // of the step that began on an earlier edge
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 edge = loop[(i + 1) % loop.size()] - loop[i];
    const double edge_mm = std::sqrt(edge.x * edge.x + edge.y * edge.y);
    if (edge_mm <= 0.0) continue;
    const Vec2 along = (1.0 / edge_mm) * edge;
    if (edge_mm > kRimStepMm) left_mm = 0.0;  // a true corner may touch: it is a point
    double at_mm = left_mm;
    for (; at_mm < edge_mm; at_mm += kRimStepMm) visit(loop[i] + at_mm * along, along);
    left_mm = at_mm - edge_mm;
  }
}

/// The higher side of the step at a point of a loop, looked up a little ahead of it: beside a
/// corner may be outside on both sides.
std::optional<double> step_height_mm(const Part& part, Vec2 p, Vec2 along) {
  constexpr double kAheadMm = 1e-4;
  constexpr double kAsideMm = 2e-5;
  const Vec2 ahead = p + kAheadMm * along;
  const Vec2 left = kAsideMm * Vec2{-along.y, along.x};
  const auto a = top_height_mm(part, ahead + left);
  const auto b = top_height_mm(part, ahead - left);
  if (!a || !b) return a ? a : b;
  return std::max(*a, *b);
}

}  // namespace

Rims rims(const Part& part) {
  Rims result;
  const auto add_top = [&](Vec2 p, Vec2 along) {
    if (const auto z_mm = step_height_mm(part, p, along))
      result.top_mm.push_back({p.x, p.y, *z_mm});
  };
  const auto add_both = [&](Vec2 p, Vec2 along) {
    add_top(p, along);
    result.bottom_mm.push_back({p.x, p.y, -part.thickness_mm});
  };
  walk(part.outline.outer, add_both);
  for (const Loop& hole : part.outline.holes) walk(hole, add_both);
  for (const Area& area : part.areas) walk(area.loop, add_top);
  return result;
}

Vec3 center_of_mass_mm(const Part& part) {
  // The slab's is below the origin, which is the outline's centroid; areas are summed on a grid.
  const double slab_mm3 = area_mm2(part) * part.thickness_mm;
  double volume_mm3 = slab_mm3;
  Vec3 moment{0.0, 0.0, -0.5 * part.thickness_mm * slab_mm3};
  if (!part.areas.empty()) {
    const int reach = static_cast<int>(std::ceil(radius_mm(part)));
    for (int j = -reach; j < reach; ++j) {
      const TopRow row(part, j + 0.5);
      for (int i = -reach; i < reach; ++i) {
        const Vec2 p{i + 0.5, j + 0.5};
        const double height_mm = row.height_mm(p.x).value_or(0.0);
        volume_mm3 += height_mm;
        moment = moment + height_mm * Vec3{p.x, p.y, 0.5 * height_mm};
      }
    }
  }
  return (1.0 / volume_mm3) * moment;
}

}  // namespace flatpose::sim
