#include "flatpose/teach/symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flatpose/core/maths.hpp"

namespace flatpose::teach {
namespace {

Vec3 middle_of(const model::Template& part) noexcept {
  Vec3 sum;
  for (const model::ContourPoint& p : part.contour_points()) sum = sum + Vec3{p.x_mm, p.y_mm, 0.0};
  return (1.0 / std::max(1, part.contour_count)) * sum;
}

// Two unknowns, symmetric positive: A c = b.
Vec3 solve(double a00, double a01, double a11, double b0, double b1,
           const Vec3& otherwise) noexcept {
  const double determinant = a00 * a11 - a01 * a01;
  if (!(determinant > 1e-9 * (a00 + a11) * (a00 + a11))) return otherwise;
  return {(a11 * b0 - a01 * b1) / determinant, (a00 * b1 - a01 * b0) / determinant, 0.0};
}

// Every normal's line passes through the centre: minimise the sum of squared distances, t . (q - c)
// with t across n.
Vec3 meeting_of_normals(const model::Template& part) noexcept {
  double a00 = 0, a01 = 0, a11 = 0, b0 = 0, b1 = 0;
  for (const model::ContourPoint& p : part.contour_points()) {
    const double tx = -p.ny;
    const double ty = p.nx;
    const double tq = tx * p.x_mm + ty * p.y_mm;
    a00 += tx * tx;
    a01 += tx * ty;
    a11 += ty * ty;
    b0 += tx * tq;
    b1 += ty * tq;
  }
  return solve(a00, a01, a11, b0, b1, middle_of(part));
}

struct Turned {
  double x;
  double y;
  double nx;
  double ny;
};

Turned turned(const model::ContourPoint& p, const Vec3& c, const SinCos& turn) noexcept {
  const double dx = p.x_mm - c.x;
  const double dy = p.y_mm - c.y;
  return {c.x + turn.cos * dx - turn.sin * dy, c.y + turn.sin * dx + turn.cos * dy,
          turn.cos * p.nx - turn.sin * p.ny, turn.sin * p.nx + turn.cos * p.ny};
}

// The contour point nearest to a turned one among those that face the same way; null when none
// does.
const model::ContourPoint* nearest(
    const model::Template& part, const Turned& q,
    double reach_mm = std::numeric_limits<double>::infinity()) noexcept {
  constexpr double kCosineMin = 0.8;
  const model::ContourPoint* best = nullptr;
  double best2 = reach_mm * reach_mm;
  for (const model::ContourPoint& p : part.contour_points()) {
    if (p.nx * q.nx + p.ny * q.ny < kCosineMin) continue;
    const double d2 = (p.x_mm - q.x) * (p.x_mm - q.x) + (p.y_mm - q.y) * (p.y_mm - q.y);
    if (d2 >= best2) continue;
    best = &p;
    best2 = d2;
  }
  return best;
}

// A turn by 360/N lays the contour onto itself but for a shift t = (1 - R)(c_true - c): solved for
// c, again and again, from counterparts within a reach that begins at `reach_cells`.
Vec3 center_of_turn(const model::Template& part, int order, Vec3 c,
                    double reach_cells = 32.0) noexcept {
  constexpr int kRoundCount = 16;
  constexpr double kReachMin = 3.0;
  const SinCos turn = sin_cos(2.0 * kPi / order);
  for (int round = 0; round < kRoundCount; ++round) {
    // What has no counterpart (a hole seen in part) must not take another's: the reach shrinks as
    // the centre settles.
    const double reach_mm = std::max(kReachMin, reach_cells / (1 << round)) * part.cell_mm;
    double a00 = 0, a01 = 0, a11 = 0, b0 = 0, b1 = 0;
    for (const model::ContourPoint& p : part.contour_points()) {
      const Turned q = turned(p, c, turn);
      const model::ContourPoint* match = nearest(part, q, reach_mm);
      if (match == nullptr) continue;
      // Across the mean of both directions: two points of one arc then lie in no gap, however far
      // they are apart along it.
      const Vec3 across = normalized({match->nx + q.nx, match->ny + q.ny, 0.0});
      const double nx = across.x;
      const double ny = across.y;
      const double gap = nx * (match->x_mm - q.x) + ny * (match->y_mm - q.y);
      const double cells = gap / part.cell_mm;
      const double weight = 1.0 / (1.0 + cells * cells);  // a contour gone astray pulls little
      a00 += weight * nx * nx;
      a01 += weight * nx * ny;
      a11 += weight * ny * ny;
      b0 += weight * nx * gap;
      b1 += weight * ny * gap;
    }
    const Vec3 t = solve(a00, a01, a11, b0, b1, {});
    // (1 - R)^-1 t; its determinant 2 (1 - cos) is not zero for N >= 2.
    const double k = 1.0 - turn.cos;
    const double determinant = 2.0 * k;
    c.x += (k * t.x - turn.sin * t.y) / determinant;
    c.y += (turn.sin * t.x + k * t.y) / determinant;
  }
  return c;
}

// Any turn lays it onto itself: the mean over some that share no points. The normals meet near the
// centre already, and what is seen of an arc alone has no counterpart farther off.
Vec3 center_of_every_turn(const model::Template& part) noexcept {
  constexpr std::array<int, 4> kOrders = {2, 3, 5, 7};
  constexpr double kReach = 4.0;  // cells
  const Vec3 start = meeting_of_normals(part);
  Vec3 sum;
  for (const int order : kOrders) sum = sum + center_of_turn(part, order, start, kReach);
  return (1.0 / kOrders.size()) * sum;
}

}  // namespace

Vec3 symmetry_center(const model::Template& part) noexcept {
  if (part.symmetry.order == model::kFullSymmetry) return center_of_every_turn(part);
  return part.symmetry.order > 1 ? center_of_turn(part, part.symmetry.order, middle_of(part))
                                 : middle_of(part);
}

double overlap_after_turn(const model::Template& part, double x_mm, double y_mm, double angle_rad,
                          double tolerance_mm) noexcept {
  const SinCos turn = sin_cos(angle_rad);
  int count = 0;
  for (const model::ContourPoint& p : part.contour_points()) {
    const Turned q = turned(p, {x_mm, y_mm, 0.0}, turn);
    const model::ContourPoint* match = nearest(part, q);
    if (match == nullptr) continue;
    // Along the contour the points lie apart; across it they must agree.
    const double across = match->nx * (q.x - match->x_mm) + match->ny * (q.y - match->y_mm);
    const double along = match->nx * (q.y - match->y_mm) - match->ny * (q.x - match->x_mm);
    if (std::fabs(across) <= tolerance_mm && std::fabs(along) <= 4.0 * tolerance_mm) ++count;
  }
  return static_cast<double>(count) / std::max(1, part.contour_count);
}

int likely_symmetry(const model::Template& part, double tolerance_mm) noexcept {
  constexpr double kOverlapMin = 0.93;
  constexpr int kOrderMax = 8;
  const auto looks_alike = [&](int order) {
    const Vec3 c = center_of_turn(part, order, middle_of(part));
    return overlap_after_turn(part, c.x, c.y, 2.0 * kPi / order, tolerance_mm) >= kOverlapMin;
  };
  if (looks_alike(7) && looks_alike(5)) return model::kFullSymmetry;
  for (int order = kOrderMax; order >= 2; --order) {
    if (looks_alike(order)) return order;
  }
  return 1;
}

}  // namespace flatpose::teach
