#pragma once
// One row of a scan in the grid of a height map: what the painters of this room read. Places are
// integers, so that inside and outside are decided exactly and no crack can open between triangles.
//
// A place is snapped to the middle of a subcell, 1/2048 of a cell wide: in units of half a subcell
// it is odd, and the centre of cell i lies at i * kUnitsPerCell, which is even. So no corner ever
// lies on a cell centre's row or column, and a scan whose pitch is the cell's puts one centre into
// a quad, not four.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/height_map.hpp"

namespace flatpose::rectify {

inline constexpr int kUnitBits = 12;
inline constexpr std::int32_t kUnitsPerCell = 1 << kUnitBits;
/// A point farther than this from cell (0, 0) is as good as missing: products of units stay in
/// 64 bits.
inline constexpr int kReach_px = 1 << 16;
inline constexpr int kSideMax_px = 32767;         ///< Cells along a side of a grid.
inline constexpr int kScanSideMax_px = 65535;     ///< Pixels along a side of a scan.
inline constexpr int kScanPointsMax = 1 << 26;    ///< Pixels of a scan.
inline constexpr double kCoordinateMax_mm = 1e6;  ///< A larger coordinate is no measurement.

inline constexpr int kRowPadding = 16;  ///< As much as the widest vector may read beyond.

/// Column, row and height of each point of a scan row, and of kRowPadding missing points beyond. A
/// missing point has a NaN height.
struct ScanRow {
  std::span<std::int32_t> u;  ///< Column in units of 1 / kUnitsPerCell.
  std::span<std::int32_t> v;  ///< Row, likewise.
  std::span<float> z_mm;

  static ScanRow take(Arena& arena, int width_px) noexcept;
};

/// The cell that holds a place.
[[nodiscard]] inline std::int32_t cell_of(std::int32_t place) noexcept {
  return (place + kUnitsPerCell / 2) >> kUnitBits;
}

inline constexpr double kReach_subcells = 1.0 * kReach_px * (kUnitsPerCell / 2);

/// From the scan's coordinates to places in a grid and heights above the work plane.
struct ScanToGrid {
  double u[4];  ///< column * (units per cell / 2) + what makes it positive within reach.
  double v[4];
  double z[4];
  /// Scan and grid axes agree but for their sense: the common sensor over a plane.
  bool is_straight;

  ScanToGrid(const Pose& work_T_scan, const Grid& grid) noexcept;
};

/// What must hold of a scan and its pose before anything starts.
/// Fails: kNotFinite (pose), kInvalidArgument (size, planes, strides, a pose kilometres away),
/// kTooLarge.
[[nodiscard]] Status check_scan(const RangeImageView& scan, const Pose& work_T_scan) noexcept;

/// What must hold of the arguments of every method, check_scan() included.
/// Fails: also kInvalidArgument, kNotFinite and kTooLarge for the grid, kShapeMismatch when an
/// image is not as large as the grid.
[[nodiscard]] Status check_arguments(const RangeImageView& scan, const Pose& work_T_scan,
                                     const HeightMap& out) noexcept;

/// Every cell, or every one of a window, missing.
void clear(const HeightMap& map, const CellWindow& window) noexcept;
inline void clear(const HeightMap& map) noexcept { clear(map, whole(map.grid)); }

}  // namespace flatpose::rectify
