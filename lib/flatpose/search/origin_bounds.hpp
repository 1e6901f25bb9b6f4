#pragma once
// Where the part's origin may not lie: hypotheses that are sure to end there are no candidates, so
// that they take no room from the others.

#include <limits>
#include <span>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/region.hpp"

namespace flatpose::search {

struct OriginBounds {
  Pose face_T_work;
  double height_min_mm = -std::numeric_limits<double>::infinity();  ///< z at the face.
  double height_max_mm = std::numeric_limits<double>::infinity();
  std::span<const Region> exclusions{};  ///< In the face's x and y.

  /// Whether an origin that is known to `margin_mm` may lie inside the bounds.
  [[nodiscard]] bool admits(const Vec3& origin_work_mm, double margin_mm) const noexcept {
    const Vec3 p = face_T_work * origin_work_mm;
    if (p.z < height_min_mm - margin_mm || p.z > height_max_mm + margin_mm) return false;
    for (const Region& region : exclusions) {
      if (region.contains(p.x, p.y) && region.border_distance_mm(p.x, p.y) >= margin_mm)
        return false;
    }
    return true;
  }
};

}  // namespace flatpose::search
