#pragma once
// A scene cut into vertical columns, to judge finished scenes by: which bodies a column goes
// through, and from where to where. Knows nothing of how the scene came about.

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "port/sim/scene.hpp"
#include "port/sim/solid.hpp"

namespace flatpose::sim {

inline bool in_material(const Instance& body, const Vec3& p_scan_mm) {
  const Vec3 p = body.scan_T_object.inverse() * p_scan_mm;
  const auto top_mm = top_height_mm(*body.part, {p.x, p.y});
  return top_mm && p.z > -body.part->thickness_mm && p.z < *top_mm;
}

/// What of one body a column holds; over its hollows, if there are any, as if they were filled.
struct Piece {
  int body;
  double low_mm;
  double high_mm;
};

class Columns {
 public:
  explicit Columns(const Scene& scene, double pitch_mm) : pitch_mm_(pitch_mm) {
    bodies_ = scene.instances;
    bodies_.insert(bodies_.end(), scene.fixtures.begin(), scene.fixtures.end());
    std::map<const Part*, std::unique_ptr<Solid>> solids;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      auto& solid = solids[bodies_[i].part.get()];
      if (!solid) solid = std::make_unique<Solid>(bodies_[i].part);
      cut(static_cast<int>(i), *solid);
    }
  }

  /// How deep a body reaches into another, as the diameter of the largest ball (of a few sizes)
  /// that lies in both, or under the floor.
  [[nodiscard]] double deepest_overlap_mm() const {
    double deepest_mm = 0.0;
    for (const auto& [place, pieces] : columns_) {
      for (const Piece& a : pieces) {
        deepest_mm = std::max(deepest_mm, -a.low_mm);
        for (const Piece& b : pieces) {
          if (a.body >= b.body) continue;
          deepest_mm = std::max(deepest_mm, overlap_mm(place, a, b));
        }
      }
    }
    return deepest_mm;
  }

  /// Whether the point, seen from above, lies in the hull of the places where the gap under the
  /// body is at most `gap_mm`. A corner may lie on less than a column of another body, so what the
  /// columns around hold is under the body too; the hull is made wider by as much.
  [[nodiscard]] bool rests(int body, const Vec3& point_mm, double gap_mm) const {
    std::vector<Vec2> contacts;
    for (const auto& [place, pieces] : columns_) {
      const auto own = std::find_if(pieces.begin(), pieces.end(),
                                    [&](const Piece& piece) { return piece.body == body; });
      if (own == pieces.end()) continue;
      if (own->low_mm - highest_under_mm(place, *own) <= gap_mm) contacts.push_back(xy(place));
    }
    // Outside of the hull: some direction in which all contacts lie behind the point.
    for (int deg = 0; deg < 360; deg += 2) {
      const Vec2 direction{std::cos(deg * kRadPerDeg), std::sin(deg * kRadPerDeg)};
      const bool all_behind = std::all_of(contacts.begin(), contacts.end(), [&](Vec2 p) {
        const Vec2 d = p - Vec2{point_mm.x, point_mm.y};
        return d.x * direction.x + d.y * direction.y < -pitch_mm_;
      });
      if (all_behind) return false;
    }
    return true;
  }

 private:
  using Place = std::pair<int, int>;
  [[nodiscard]] Vec2 xy(Place p) const { return {p.first * pitch_mm_, p.second * pitch_mm_}; }

  [[nodiscard]] double highest_under_mm(Place place, const Piece& own) const {
    constexpr double kOverlapMm = 0.5;
    double highest_mm = 0.0;  // the floor
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const auto pieces = columns_.find({place.first + i, place.second + j});
        if (pieces == columns_.end()) continue;
        for (const Piece& other : pieces->second) {
          if (other.body == own.body || other.high_mm > own.low_mm + kOverlapMm) continue;
          highest_mm = std::max(highest_mm, other.high_mm);
        }
      }
    }
    return highest_mm;
  }

  void cut(int index, const Solid& solid) {
    const Instance& body = bodies_[index];
    const Pose object_T_scan = body.scan_T_object.inverse();
    Vec3 low_mm{1e9, 1e9, 1e9};
    Vec3 high_mm{-1e9, -1e9, -1e9};
    for (const Vec2 p : body.part->outline.outer) {
      for (const double z_mm : {-body.part->thickness_mm, height_max_mm(*body.part)}) {
        const Vec3 q = body.scan_T_object * Vec3{p.x, p.y, z_mm};
        low_mm = {std::min(low_mm.x, q.x), std::min(low_mm.y, q.y), std::min(low_mm.z, q.z)};
        high_mm = {std::max(high_mm.x, q.x), std::max(high_mm.y, q.y), std::max(high_mm.z, q.z)};
      }
    }
    const auto cell = [&](double at_mm) { return static_cast<int>(std::floor(at_mm / pitch_mm_)); };
    for (int j = cell(low_mm.y); j <= cell(high_mm.y) + 1; ++j) {
      for (int i = cell(low_mm.x); i <= cell(high_mm.x) + 1; ++i) {
        const Vec2 p = xy({i, j});
        const auto hit = [&](double z_mm, double direction) {
          const Ray ray{object_T_scan * Vec3{p.x, p.y, z_mm},
                        object_T_scan.rotation * Vec3{0, 0, direction}};
          return solid.first_hit(ray, 0.0, high_mm.z - low_mm.z + 2.0);
        };
        const double top_mm = high_mm.z + 1.0;
        const double bottom_mm = low_mm.z - 1.0;
        const auto down = hit(top_mm, -1.0);
        const auto up = hit(bottom_mm, 1.0);
        if (!down || !up) continue;
        columns_[{i, j}].push_back(
            {index, bottom_mm + up->distance_mm, top_mm - down->distance_mm});
      }
    }
  }

  [[nodiscard]] double overlap_mm(Place place, const Piece& a, const Piece& b) const {
    const double low_mm = std::max(a.low_mm, b.low_mm);
    const double high_mm = std::min(a.high_mm, b.high_mm);
    double deepest_mm = 0.0;
    const Vec2 p = xy(place);
    const Vec3 middle_mm{p.x, p.y, 0.5 * (low_mm + high_mm)};
    for (double ball_mm = 0.1; ball_mm <= high_mm - low_mm && ball_mm < 20.0; ball_mm *= 1.25) {
      if (!holds_ball(bodies_[a.body], middle_mm, 0.5 * ball_mm) ||
          !holds_ball(bodies_[b.body], middle_mm, 0.5 * ball_mm)) {
        break;
      }
      deepest_mm = ball_mm;
    }
    return deepest_mm;
  }

  static bool holds_ball(const Instance& body, const Vec3& p_mm, double radius_mm) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 along = body.scan_T_object.rotation.column(axis);
      if (!in_material(body, p_mm + radius_mm * along)) return false;
      if (!in_material(body, p_mm - radius_mm * along)) return false;
    }
    return true;
  }

  double pitch_mm_;
  std::vector<Instance> bodies_;
  std::map<Place, std::vector<Piece>> columns_;
};

}  // namespace flatpose::sim
