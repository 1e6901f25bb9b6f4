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

TopRow::TopRow(const Part& part, double y_mm)
    : part_(part), outer_(crossings(part.outline.outer, y_mm)) {
  for (const Loop& hole : part.outline.holes) holes_.push_back(crossings(hole, y_mm));
  for (const Area& area : part.areas) areas_.push_back(crossings(area.loop, y_mm));
}

TopRow::Crossings TopRow::crossings(const Loop& loop, double y_mm) {
  Crossings found;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Vec2 a = loop[i];
    const Vec2 b = loop[j];
    if ((a.y > y_mm) == (b.y > y_mm)) continue;
    found.push_back(a.x + (b.x - a.x) * (y_mm - a.y) / (b.y - a.y));
  }
  return found;
}

bool TopRow::is_inside(const Crossings& crossings, double x_mm) noexcept {
  return std::count_if(crossings.begin(), crossings.end(), [x_mm](double x) { return x_mm < x; }) %
             2 !=
         0;
}

std::optional<double> TopRow::height_mm(double x_mm) const noexcept {
  if (!is_inside(outer_, x_mm)) return std::nullopt;
  for (const Crossings& hole : holes_) {
    if (is_inside(hole, x_mm)) return std::nullopt;
  }
  for (std::size_t i = areas_.size(); i-- > 0;) {
    if (is_inside(areas_[i], x_mm)) return part_.areas[i].height_mm;
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
