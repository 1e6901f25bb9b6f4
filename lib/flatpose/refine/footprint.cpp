#include "flatpose/refine/footprint.hpp"

#include <algorithm>
#include <cmath>

namespace flatpose::refine {
namespace {

int patch_radius_px(const model::Template& part) noexcept {
  const double spacing_mm = std::sqrt(part.area_mm2 / std::max(1, part.surface_count));
  const double radius_px = 0.5 * (spacing_mm / part.pitch_mm - 1.0);
  return std::clamp(static_cast<int>(radius_px), 0, Footprint::kPatchRadiusMax_px);
}

}  // namespace

Footprint take_footprint(Arena& arena) noexcept {
  Footprint footprint;
  footprint.above_mm = arena.take<float>(Footprint::kCapacity);
  footprint.x_mm = arena.take<float>(Footprint::kCapacity);
  footprint.y_mm = arena.take<float>(Footprint::kCapacity);
  return footprint;
}

void gather(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
            bool thinned, Footprint& footprint) noexcept {
  const Pose object_T_scan = work_T_object.inverse() * raw.work_T_scan;
  const int radius_px = patch_radius_px(part);
  const int step_px = thinned ? 2 : 1;
  const auto first = [&](int centre) {
    const int begin = std::max(centre - radius_px, 0);
    return begin + begin % step_px;
  };
  int count = 0;
  for (const model::SurfacePoint& p : part.surface_points()) {
    const Pixel centre = raw.pixel_under(work_T_object * Vec3{p.x_mm, p.y_mm, p.z_mm});
    if (centre.is_none()) continue;
    const double nz2 = 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny;
    const double nz = std::sqrt(std::max(0.25, nz2));
    const Vec3 slope{p.nx / nz, p.ny / nz, 1.0};
    const Vec3 p_mm{p.x_mm, p.y_mm, p.z_mm};
    const int row_end = std::min(centre.row + radius_px + 1, raw.scan.height_px);
    const int column_end = std::min(centre.column + radius_px + 1, raw.scan.width_px);
    for (int row = first(centre.row); row < row_end; row += step_px) {
      for (int column = first(centre.column); column < column_end; column += step_px) {
        const Vec3 q_scan_mm = raw.scan(column, row);
        if (!is_valid(q_scan_mm)) continue;
        const Vec3 q_mm = object_T_scan * q_scan_mm;
        footprint.above_mm[count] = static_cast<float>(dot(slope, q_mm - p_mm));
        footprint.x_mm[count] = static_cast<float>(q_mm.x);
        footprint.y_mm[count] = static_cast<float>(q_mm.y);
        ++count;
      }
    }
  }
  footprint.count = count;
  constexpr float kFar_mm = 1e15F;
  for (; count % Footprint::kLaneCount != 0; ++count) {
    footprint.above_mm[count] = kFar_mm;
    footprint.x_mm[count] = footprint.y_mm[count] = 0.0F;
  }
}

}  // namespace flatpose::refine
