#pragma once
// The way from a place in the height map back to the scan's own points, which the last step is
// fitted to.

#include "flatpose/core/maths.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/height_map.hpp"

namespace flatpose::refine {

struct Pixel {
  int column = -1;
  int row = -1;
  [[nodiscard]] bool is_none() const noexcept { return column < 0; }
};

struct RawScan {
  RangeImageView scan;
  Pose work_T_scan;
  const rectify::HeightMap* map = nullptr;

  /// The pixel that fed the cell under a point of the work frame, or none.
  [[nodiscard]] Pixel pixel_under(const Vec3& p_work_mm) const noexcept {
    const int column = rounded(map->grid.column_of(p_work_mm.x));
    const int row = rounded(map->grid.row_of(p_work_mm.y));
    if (!map->source_index.contains(column, row)) return {};
    const std::int32_t source = map->source_index(column, row);
    if (source == rectify::kNoSource) return {};
    return {source % scan.width_px, source / scan.width_px};
  }
};

}  // namespace flatpose::refine
