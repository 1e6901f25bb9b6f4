#include "port/sim/part.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace flatpose::sim {
namespace {

void require(bool holds, const Part& part, const char* what) {
  if (!holds) throw std::invalid_argument("part '" + part.name + "': " + what);
}

void require_loop(const Loop& loop, const Part& part) {
  require(loop.size() >= 3, part, "a loop has fewer than three points");
  require(signed_area_mm2(loop) > 0.0, part, "a loop is not anticlockwise");
}

}  // namespace

Part make_part(Part part) {
  require_loop(part.outline.outer, part);
  for (const Loop& hole : part.outline.holes) require_loop(hole, part);
  require(1 + part.outline.holes.size() + part.areas.size() <= kLoopsMax, part, "too many loops");
  require(part.thickness_mm > 0.0, part, "thickness_mm must be > 0");
  for (const Area& area : part.areas) {
    require_loop(area.loop, part);
    require(area.height_mm > -part.thickness_mm, part, "a recess goes through");
  }
  require(area_mm2(part.outline) > 0.0, part, "nothing is left between the holes");
  const Vec2 to_origin = -1.0 * centroid_mm(part.outline);
  move(part.outline.outer, to_origin);
  for (Loop& hole : part.outline.holes) move(hole, to_origin);
  for (Area& area : part.areas) move(area.loop, to_origin);
  return part;
}

double area_mm2(const Part& part) noexcept { return area_mm2(part.outline); }
double contour_length_mm(const Part& part) noexcept { return contour_length_mm(part.outline); }
bool contains(const Part& part, Vec2 p_mm) noexcept { return contains(part.outline, p_mm); }

std::optional<double> top_height_mm(const Part& part, Vec2 p_mm) noexcept {
  if (!contains(part.outline, p_mm)) return std::nullopt;
  for (auto area = part.areas.rbegin(); area != part.areas.rend(); ++area) {
    if (contains(area->loop, p_mm)) return area->height_mm;
  }
  return 0.0;
}

double height_max_mm(const Part& part) noexcept {
  double highest = 0.0;
  for (const Area& area : part.areas) highest = std::max(highest, area.height_mm);
  return highest;
}

double radius_mm(const Part& part) noexcept {
  double squared = 0.0;
  for (const Vec2 p : part.outline.outer) squared = std::max(squared, p.x * p.x + p.y * p.y);
  return std::sqrt(squared);
}

}  // namespace flatpose::sim
