#pragma once
// The test of one cell for a jump, and the measuring of a jump found. Parts of detect_edges.

#include "flatpose/image/edge.hpp"
#include "flatpose/image/slope_field.hpp"

namespace flatpose::image {

/// Cells over which a step may be smeared and still count with its full height.
inline constexpr float kSmear_px = 3.0F;
/// Distance at which the slope beside an edge is read, beyond the reach of Sobel's corners.
inline constexpr int kBeside_px = 3;

/// How far the height jumps at a cell, if the cell is the top of a ridge of slopes.
/// Returns 0 when it is none or falls from a missing cell; `kind` tells what lies below.
struct JumpTest {
  float strength_mm = 0.0F;
  EdgeKind kind = EdgeKind::kNone;
};
[[nodiscard]] JumpTest test_jump(const SlopeField& field, int column, int row,
                                 float jump_low_mm) noexcept;

/// Place, direction and height of the jump at a cell that test_jump accepted.
[[nodiscard]] EdgePoint measure_jump(const SlopeField& field, int column, int row,
                                     float jump_low_mm) noexcept;

}  // namespace flatpose::image
