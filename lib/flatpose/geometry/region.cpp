#include "flatpose/geometry/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose {
namespace {

bool polygon_contains(const Region& r, double x, double y) noexcept {
  bool inside = false;
  for (int i = 0, j = r.vertex_count - 1; i < r.vertex_count; j = i++) {
    const double yi = r.vertex_y_mm[i];
    const double yj = r.vertex_y_mm[j];
    if ((yi > y) == (yj > y)) continue;
    const double t = (y - yi) / (yj - yi);
    if (x < r.vertex_x_mm[i] + t * (r.vertex_x_mm[j] - r.vertex_x_mm[i])) inside = !inside;
  }
  return inside;
}

double segment_distance_mm(double ax, double ay, double bx, double by, double x,
                           double y) noexcept {
  const double dx = bx - ax;
  const double dy = by - ay;
  const double square = dx * dx + dy * dy;
  const double along = square > 0.0 ? ((x - ax) * dx + (y - ay) * dy) / square : 0.0;
  const double t = std::clamp(along, 0.0, 1.0);
  const double off_x = x - ax - t * dx;
  const double off_y = y - ay - t * dy;
  return std::sqrt(off_x * off_x + off_y * off_y);
}

double polygon_border_distance_mm(const Region& r, double x, double y) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0, j = r.vertex_count - 1; i < r.vertex_count; j = i++)
    least = std::min(least, segment_distance_mm(r.vertex_x_mm[j], r.vertex_y_mm[j],
                                                r.vertex_x_mm[i], r.vertex_y_mm[i], x, y));
  return least;
}

double box_border_distance_mm(const Box& box, double x, double y) noexcept {
  return std::min({segment_distance_mm(box.x0_mm, box.y0_mm, box.x1_mm, box.y0_mm, x, y),
                   segment_distance_mm(box.x1_mm, box.y0_mm, box.x1_mm, box.y1_mm, x, y),
                   segment_distance_mm(box.x1_mm, box.y1_mm, box.x0_mm, box.y1_mm, x, y),
                   segment_distance_mm(box.x0_mm, box.y1_mm, box.x0_mm, box.y0_mm, x, y)});
}

// Whether every corner lies on one straight line, which a slanting one may do in a box of any size.
bool is_line(const Region& r) noexcept {
  const Box box = bounding_box(r);
  const double width_mm = box.x1_mm - box.x0_mm;
  const double height_mm = box.y1_mm - box.y0_mm;
  constexpr double kRounding = 1e-12;  // of a corner's place, as a share of the box
  for (const double falls : {1.0, -1.0}) {
    bool on_diagonal = true;
    for (int i = 0; i < r.vertex_count; ++i) {
      const double x = (r.vertex_x_mm[i] - box.x0_mm) / width_mm - 0.5;
      const double y = (r.vertex_y_mm[i] - box.y0_mm) / height_mm - 0.5;
      on_diagonal = on_diagonal && std::fabs(x - falls * y) < kRounding;
    }
    if (on_diagonal) return true;
  }
  return false;
}

}  // namespace

bool Region::contains(double x, double y) const noexcept {
  switch (kind) {
    case Kind::kAll: return true;
    case Kind::kCircle: {
      const double dx = x - x_mm;
      const double dy = y - y_mm;
      return dx * dx + dy * dy <= radius_mm * radius_mm;
    }
    case Kind::kBox: {
      const Box box = bounding_box(*this);
      return x >= box.x0_mm && x <= box.x1_mm && y >= box.y0_mm && y <= box.y1_mm;
    }
    case Kind::kPolygon: return polygon_contains(*this, x, y);
  }
  return false;
}

double Region::border_distance_mm(double x, double y) const noexcept {
  switch (kind) {
    case Kind::kAll: break;
    case Kind::kCircle: {
      const double dx = x - x_mm;
      const double dy = y - y_mm;
      return std::fabs(std::sqrt(dx * dx + dy * dy) - radius_mm);
    }
    case Kind::kBox: return box_border_distance_mm(bounding_box(*this), x, y);
    case Kind::kPolygon: return polygon_border_distance_mm(*this, x, y);
  }
  return std::numeric_limits<double>::infinity();
}

Box bounding_box(const Region& r) noexcept {
  if (r.kind == Region::Kind::kCircle) {
    return {r.x_mm - r.radius_mm, r.y_mm - r.radius_mm, r.x_mm + r.radius_mm, r.y_mm + r.radius_mm};
  }
  Box box{r.vertex_x_mm[0], r.vertex_y_mm[0], r.vertex_x_mm[0], r.vertex_y_mm[0]};
  for (int i = 1; i < r.vertex_count; ++i) {
    box.x0_mm = std::min(box.x0_mm, r.vertex_x_mm[i]);
    box.y0_mm = std::min(box.y0_mm, r.vertex_y_mm[i]);
    box.x1_mm = std::max(box.x1_mm, r.vertex_x_mm[i]);
    box.y1_mm = std::max(box.y1_mm, r.vertex_y_mm[i]);
  }
  return box;
}

bool is_valid(const Region& r) noexcept {
  const int vertex_count_min = r.kind == Region::Kind::kBox ? 2 : 3;
  switch (r.kind) {
    case Region::Kind::kAll: return true;
    case Region::Kind::kCircle:
      return std::isfinite(r.x_mm) && std::isfinite(r.y_mm) && std::isfinite(r.radius_mm) &&
             r.radius_mm > 0.0;
    case Region::Kind::kBox:
    case Region::Kind::kPolygon: break;
  }
  if (r.vertex_count < vertex_count_min || r.vertex_count > Region::kVertexCountMax) return false;
  for (int i = 0; i < r.vertex_count; ++i) {
    if (!std::isfinite(r.vertex_x_mm[i]) || !std::isfinite(r.vertex_y_mm[i])) return false;
  }
  const Box box = bounding_box(r);
  if (!(box.x1_mm > box.x0_mm && box.y1_mm > box.y0_mm)) return false;
  return r.kind == Region::Kind::kBox || !is_line(r);
}

}  // namespace flatpose
