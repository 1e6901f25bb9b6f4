#include "flatpose/rectify/scan_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose::rectify {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

bool all_finite(const double* values, int count) noexcept {
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

}  // namespace

ScanRow ScanRow::take(Arena& arena, int width_px) noexcept {
  const auto count = static_cast<std::size_t>(width_px) + kRowPadding;
  const ScanRow row{arena.take<std::int32_t>(count), arena.take<std::int32_t>(count),
                    arena.take<float>(count)};
  if (row.z_mm.empty()) return row;
  std::fill(row.u.end() - kRowPadding, row.u.end(), 0);
  std::fill(row.v.end() - kRowPadding, row.v.end(), 0);
  std::fill(row.z_mm.end() - kRowPadding, row.z_mm.end(), kMissing);
  return row;
}

ScanToGrid::ScanToGrid(const Pose& work_T_scan, const Grid& grid) noexcept {
  const double subcells_per_mm = (kUnitsPerCell / 2) / grid.cell_mm;
  const Vec3& p = work_T_scan.position_mm;
  for (int i = 0; i < 3; ++i) {
    u[i] = work_T_scan.rotation.m[i] * subcells_per_mm;
    v[i] = work_T_scan.rotation.m[3 + i] * subcells_per_mm;
    z[i] = work_T_scan.rotation.m[6 + i];
  }
  u[3] = (p.x - grid.x0_mm) * subcells_per_mm + kReach_subcells;
  v[3] = (p.y - grid.y0_mm) * subcells_per_mm + kReach_subcells;
  z[3] = p.z;
  is_straight =
      u[1] == 0.0 && u[2] == 0.0 && v[0] == 0.0 && v[2] == 0.0 && z[0] == 0.0 && z[1] == 0.0;
}

Status check_scan(const RangeImageView& scan, const Pose& work_T_scan) noexcept {
  const Vec3& p = work_T_scan.position_mm;
  const double position_mm[] = {p.x, p.y, p.z};
  if (!all_finite(position_mm, 3) || !all_finite(work_T_scan.rotation.m.data(), 9))
    return Status::kNotFinite;
  if (norm(p) > 2.0 * kCoordinateMax_mm) return Status::kInvalidArgument;
  if (scan.width_px < 0 || scan.height_px < 0) return Status::kInvalidArgument;
  if (scan.size() == 0) return Status::kOk;
  if (scan.x_mm == nullptr || scan.y_mm == nullptr || scan.z_mm == nullptr)
    return Status::kInvalidArgument;
  if (scan.pixel_stride_bytes % 4 != 0 || scan.row_stride_bytes % 4 != 0)
    return Status::kInvalidArgument;
  return scan.width_px > kScanSideMax_px || scan.height_px > kScanSideMax_px ||
                 scan.size() > kScanPointsMax
             ? Status::kTooLarge
             : Status::kOk;
}

Status check_arguments(const RangeImageView& scan, const Pose& work_T_scan,
                       const HeightMap& out) noexcept {
  if (const Status status = check_scan(scan, work_T_scan); status != Status::kOk) return status;
  const Grid& grid = out.grid;
  const double numbers[] = {grid.x0_mm, grid.y0_mm, grid.cell_mm};
  if (!all_finite(numbers, 3)) return Status::kNotFinite;
  if (grid.cell_mm <= 0.0 || grid.width_px <= 0 || grid.height_px <= 0)
    return Status::kInvalidArgument;
  if (grid.width_px > kSideMax_px || grid.height_px > kSideMax_px) return Status::kTooLarge;
  if (out.height_mm.width_px != grid.width_px || out.height_mm.height_px != grid.height_px ||
      !same_shape(out.height_mm, out.source_index))
    return Status::kShapeMismatch;
  return Status::kOk;
}

void clear(const HeightMap& map, const CellWindow& window) noexcept {
  const int count = window.column_end - window.column_begin;
  for (int y = window.row_begin; y < window.row_end; ++y) {
    std::fill_n(map.height_mm.row(y) + window.column_begin, count, kMissing);
    std::fill_n(map.source_index.row(y) + window.column_begin, count, kNoSource);
  }
}

}  // namespace flatpose::rectify
