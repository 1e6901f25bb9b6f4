#pragma once
// The test of one cell for a crease, and the measuring of a crease found. Parts of detect_edges.

#include "flatpose/image/edge.hpp"
#include "flatpose/image/slope_field.hpp"

namespace flatpose::image {

/// Distance at which slopes before and after are compared to find candidates.
inline constexpr int kCreaseReach_px = 2;

/// A crease's change of slope and where it is; turn_tan < 0 when the cell is no crease.
struct CreaseTest {
  float turn_tan = -1.0F;  ///< Tangent of the angle between the two sides; huge from 90 deg on.
  EdgePoint point;         ///< As it goes out, its kind too.
};
[[nodiscard]] CreaseTest test_crease(const SlopeField& field, int column, int row, float cell_mm,
                                     float jump_low_mm) noexcept;

}  // namespace flatpose::image
