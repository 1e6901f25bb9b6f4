#pragma once
// Edges of a height map: contours where the height jumps, and creases where the slope changes.
//
// Canny's scheme (Canny 1986) on heights: Sobel slopes, maxima along the direction of steepest
// fall, hysteresis. What is different, because a step on a tilted part must look like one on a
// level part:
//  1. The slope of the surface is subtracted from the slope at the edge: on each axis, then again
//     along the edge's own direction, the smaller of the slopes before and after it when both have
//     one sign, else nothing. (A window around the edge would itself hold the edge and leave ghosts
//     beside the contour.) What remains must also stand out from both sides, or the foot of a ramp
//     would be an edge.
//  2. The hysteresis is on the height of the step in mm: the difference of the heights two cells
//     before and after the edge, each carried to the edge along its own side's slope.
//  3. Candidates are found by row-streaming arithmetic; all else is done at candidates only.
//  4. Place and direction come from a window along the contour, opposite slopes left out, so that a
//     wall or gap of three cells keeps both of its contours.
//
// Limits: steps smeared over more than three cells lose strength; two parallel steps of one sign
// fewer than three cells apart become one; there are no edges on the outermost ring of cells,
// jumps within five cells of it may be weaker, and creases are not found there.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/result.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/image/edge.hpp"

namespace flatpose::image {

inline constexpr int kEdgeMapSizeMax_px = 32767;  ///< Of each side: places are kept in 16 bits.

struct EdgeConfig {
  /// Least step that continues a contour, in mm; > 0. Below five times the noise of a height expect
  /// false edges.
  float jump_low_mm = 2.0F;
  /// Least step that begins a contour, in mm; >= jump_low_mm. More loses faint contours.
  float jump_high_mm = 3.0F;
  /// Least change of slope that continues a crease, in rad; > 0 unless creases are off.
  float crease_low_rad = 0.0F;
  /// Least change of slope that begins a crease, in rad, up to pi/2; 0: no creases.
  float crease_high_rad = 0.0F;
};

/// kOk, or kInvalidArgument when a field is outside its range.
Status validate(const EdgeConfig& config) noexcept;

/// Takes (and leaves taken) the scratch of detect_edges, also from a measuring arena: 16 bytes a
/// cell, and up to some 600 rows of 16 bytes a cell for the slopes of chunks side by side.
void reserve_edge_scratch(Arena& arena, int width_px, int height_px) noexcept;

/// Writes every edge to `out`, row by row, its kind to the same cell of `kind_out` (all else
/// kNone), and returns how many there are.
///
/// A kept edge is kMissingBorder when the cell on its lower side was missing, kJump else; what
/// falls from a missing cell was never seen and is no edge. Shape: `filled_mm`, `missing` (as
/// fill_missing writes them) and `kind_out` alike. Units: mm, cells.  Cost: linear in cells, about
/// 1 us an edge. Memory: `scratch`, given back. Fails: kInvalidArgument (config, cell_mm),
/// kShapeMismatch, kOutOfMemory; kTooLarge when a side is beyond kEdgeMapSizeMax_px, when more than
/// half of all cells are tops of ridges, or when `out` is full: then `out` holds the first edges
/// and `kind_out` all.  Thread: reentrant; rows are shared out over `budget`.
Result<int> detect_edges(ImageView<const float> filled_mm, ImageView<const std::uint8_t> missing,
                         double cell_mm, const EdgeConfig& config, Arena& scratch,
                         ImageView<std::uint8_t> kind_out, std::span<EdgePoint> out,
                         VectorPath path = VectorPath::kPortable,
                         const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::image
