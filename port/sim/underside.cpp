#include "port/sim/underside.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "flatpose/core/maths.hpp"

namespace flatpose::sim {
namespace {

constexpr double kSameMm = 0.5;  // what a sensor could hardly tell

Loop mirrored(const Loop& loop) {
  Loop result;
  for (auto p = loop.rbegin(); p != loop.rend(); ++p) result.push_back({-p->x, p->y});
  return result;
}

double length(Vec2 p) { return std::sqrt(p.x * p.x + p.y * p.y); }

double distance_mm(Vec2 p, Vec2 from, Vec2 to) {
  const Vec2 edge = to - from;
  const Vec2 d = p - from;
  const double share = (d.x * edge.x + d.y * edge.y) / (edge.x * edge.x + edge.y * edge.y);
  return length(d - std::clamp(share, 0.0, 1.0) * edge);
}

bool is_near(Vec2 p, const Loop& loop) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (distance_mm(p, loop[i], loop[(i + 1) % loop.size()]) <= kSameMm) return true;
  }
  return false;
}

/// Whether each loop, turned, runs along one of the others.
bool runs_along(const std::vector<Loop>& loops, Rotation turn, const std::vector<Loop>& others) {
  return std::all_of(loops.begin(), loops.end(), [&](const Loop& loop) {
    return std::any_of(others.begin(), others.end(), [&](const Loop& other) {
      return std::all_of(loop.begin(), loop.end(), [&](Vec2 p) {
        const Vec3 turned = turn * Vec3{p.x, p.y, 0.0};
        return is_near({turned.x, turned.y}, other);
      });
    });
  });
}

std::vector<Loop> loops_of(const Outline& outline) {
  std::vector<Loop> loops{outline.outer};
  loops.insert(loops.end(), outline.holes.begin(), outline.holes.end());
  return loops;
}

}  // namespace

Part underside(const Part& part) {
  Part result{.name = part.name + " from below",
              .outline = {},
              .thickness_mm = part.thickness_mm,
              .areas = {},
              .symmetry_fold = part.symmetry_fold};
  result.outline.outer = mirrored(part.outline.outer);
  for (const Loop& hole : part.outline.holes) result.outline.holes.push_back(mirrored(hole));
  return result;
}

Instance underside(const Instance& instance) {
  const Pose object_T_underside{Rotation{{-1, 0, 0, 0, 1, 0, 0, 0, -1}},
                                {0.0, 0.0, -instance.part->thickness_mm}};
  return {std::make_shared<const Part>(underside(*instance.part)),
          instance.scan_T_object * object_T_underside};
}

bool same_upside_down(const Part& part) {
  if (!part.areas.empty()) return false;
  const std::vector<Loop> own = loops_of(part.outline);
  const std::vector<Loop> seen = loops_of(underside(part).outline);
  // The corner farthest from the centroid must come to lie on one as far from it.
  const Vec2 far = *std::max_element(seen.front().begin(), seen.front().end(),
                                     [](Vec2 a, Vec2 b) { return length(a) < length(b); });
  return std::any_of(own.front().begin(), own.front().end(), [&](Vec2 p) {
    if (std::fabs(length(p) - length(far)) > kSameMm) return false;
    const double turn_rad = arc_tangent(p.y, p.x) - arc_tangent(far.y, far.x);
    return runs_along(seen, rotation_about_z(turn_rad), own);
  });
}

}  // namespace flatpose::sim
