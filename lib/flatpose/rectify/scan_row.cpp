#include "flatpose/rectify/scan_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose::rectify {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr double kReach_subcells = static_cast<double>(kReach_px) * (kUnitsPerCell / 2);

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
    u_[i] = work_T_scan.rotation.m[i] * subcells_per_mm;
    v_[i] = work_T_scan.rotation.m[3 + i] * subcells_per_mm;
    z_[i] = work_T_scan.rotation.m[6 + i];
  }
  u_[3] = (p.x - grid.x0_mm) * subcells_per_mm + kReach_subcells;
  v_[3] = (p.y - grid.y0_mm) * subcells_per_mm + kReach_subcells;
  z_[3] = p.z;
  is_straight_ =
      u_[1] == 0.0 && u_[2] == 0.0 && v_[0] == 0.0 && v_[2] == 0.0 && z_[0] == 0.0 && z_[1] == 0.0;
}

template <bool kStraight, int kStrideFloats>
void ScanToGrid::transform_strided(const RangeImageView& scan, int row,
                                   const ScanRow& out) const noexcept {
  // A stride known when compiling lets the loop run on vectors; 0 stands for any other.
  constexpr auto kFloatBytes = static_cast<std::ptrdiff_t>(sizeof(float));
  const std::ptrdiff_t stride =
      kStrideFloats > 0 ? kStrideFloats : scan.pixel_stride_bytes / kFloatBytes;
  const std::ptrdiff_t skip = row * (scan.row_stride_bytes / kFloatBytes);
  const float* const xs = scan.x_mm + skip;
  const float* const ys = scan.y_mm + skip;
  const float* const zs = scan.z_mm + skip;
  std::int32_t* const out_u = out.u.data();
  std::int32_t* const out_v = out.v.data();
  float* const out_z_mm = out.z_mm.data();
  const double u0 = u_[0], u1 = u_[1], u2 = u_[2], u3 = u_[3];
  const double v0 = v_[0], v1 = v_[1], v2 = v_[2], v3 = v_[3];
  const double z0 = z_[0], z1 = z_[1], z2 = z_[2], z3 = z_[3];
  constexpr auto kReachUnits = static_cast<std::int32_t>(2 * kReach_subcells);
  const int count = scan.width_px;  // a local: stores to int32 could change the member
  for (int c = 0; c < count; ++c) {
    const double x = static_cast<double>(xs[c * stride]);
    const double y = static_cast<double>(ys[c * stride]);
    const double z = static_cast<double>(zs[c * stride]);
    const double u = kStraight ? u0 * x + u3 : u0 * x + u1 * y + u2 * z + u3;
    const double v = kStraight ? v1 * y + v3 : v0 * x + v1 * y + v2 * z + v3;
    const double w_mm = kStraight ? z2 * z + z3 : z0 * x + z1 * y + z2 * z + z3;
    // A NaN or infinite coordinate fails one of these: 0 * NaN is NaN.
    const bool seen = (u >= 0.0) & (u < 2.0 * kReach_subcells) & (v >= 0.0) &
                      (v < 2.0 * kReach_subcells) & (std::fabs(w_mm) <= kCoordinateMax_mm);
    const double u_seen = seen ? u : 0.0;
    const double v_seen = seen ? v : 0.0;
    const double w_seen_mm = seen ? w_mm : std::numeric_limits<double>::quiet_NaN();
    out_u[c] = 2 * static_cast<std::int32_t>(u_seen) + 1 - kReachUnits;
    out_v[c] = 2 * static_cast<std::int32_t>(v_seen) + 1 - kReachUnits;
    out_z_mm[c] = static_cast<float>(w_seen_mm);
  }
}

template <bool kStraight>
void ScanToGrid::transform_any(const RangeImageView& scan, int row,
                               const ScanRow& out) const noexcept {
  switch (scan.pixel_stride_bytes) {
    case 1 * sizeof(float): return transform_strided<kStraight, 1>(scan, row, out);
    case 3 * sizeof(float): return transform_strided<kStraight, 3>(scan, row, out);
    case 4 * sizeof(float): return transform_strided<kStraight, 4>(scan, row, out);
    default: return transform_strided<kStraight, 0>(scan, row, out);
  }
}

void ScanToGrid::transform(const RangeImageView& scan, int row, const ScanRow& out) const noexcept {
  if (is_straight_) return transform_any<true>(scan, row, out);
  transform_any<false>(scan, row, out);
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

void clear(const HeightMap& map) noexcept {
  for (int y = 0; y < map.height_mm.height_px; ++y) {
    std::fill_n(map.height_mm.row(y), map.height_mm.width_px, kMissing);
    std::fill_n(map.source_index.row(y), map.source_index.width_px, kNoSource);
  }
}

}  // namespace flatpose::rectify
