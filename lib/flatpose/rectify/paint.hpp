#pragma once
// Rectification by painting (Ingberg 2015, section 2.8.1): every 2x2 quad of scan pixels is two
// triangles, and each cell of the height map whose centre lies in a triangle takes the height of
// its plane there. A connected surface stays connected, whatever the scan's pitch and direction.
//
// A triangle is painted when its three edges hold: both ends valid, the step in height not larger
// than the surface may make, the gap not longer than allowed. One test per edge and a table of 64
// entries decide the whole quad, so a quad with a lost corner costs what any other does: it paints
// the triangle that is left. When a quad's first diagonal leaves fewer triangles than its second,
// the second is taken, so that contours in every direction are cut alike.
//
// Where triangles overlap, the point nearest the sensor (highest) wins; of equals the first in scan
// order. A lone point, which no triangle uses, paints nothing: in laser triangulation it is more
// often a false echo in a shadow than a surface, and a missing cell does less harm than a false
// edge.
//
// Limits: a point more than 65536 cells from the grid's origin counts as missing. Places are
// snapped to 1/2048 of a cell.

#include <cstddef>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/height_map.hpp"
#include "flatpose/rectify/scan_reach.hpp"

namespace flatpose::rectify {

inline constexpr int kStepMax_px = 64;

struct PaintConfig {
  /// An edge of a triangle may step by jump_mm + max_slope * (its length in x and y). [0, 1e6].
  /// More bridges the side walls of low parts; less leaves holes where noise is high.
  double jump_mm = 1.0;
  double max_slope = 2.0;   ///< mm per mm, [0, 1e6].
  double max_gap_mm = 5.0;  ///< The longest edge in x and y, (0, 1e6]: some three pixel pitches.
  /// Only every so many-th row and column of the scan is read, 1..kStepMax_px: where the scan is
  /// finer than the map, more of them show nothing more.
  int step_px = 1;
  VectorPath vector_path = VectorPath::kPortable;  ///< One that the processor has.
  /// Of the same scan and pose, from its survey: with it, parts of the map are painted side by
  /// side.
  const ScanReach* reach = nullptr;
};

/// Fails: kInvalidArgument when a field is outside its range.
[[nodiscard]] Status validate(const PaintConfig& config) noexcept;

/// Bytes of scratch that paint() takes for a scan of this width.
[[nodiscard]] std::size_t paint_required_bytes(int scan_width_px) noexcept;

/// Paints `scan` into `out`, whose grid and images the caller gives; they are cleared first.
/// source_index is the pixel (of all, not of those read) of the winning triangle's corner nearest
/// to the cell's centre. Units/frames: heights are z of the work frame.  Cost: linear in pixels and
/// cells painted. Memory: a few rows of scratch, given back.  Fails: kInvalidArgument, kNotFinite,
/// kTooLarge, kShapeMismatch, kOutOfMemory; `out` is then as it was.  Thread: reentrant; parts of
/// the map are shared out over `budget`.
[[nodiscard]] Status paint(const RangeImageView& scan, const Pose& work_T_scan,
                           const PaintConfig& config, Arena& scratch, const HeightMap& out,
                           const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::rectify
