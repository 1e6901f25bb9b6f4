#pragma once
// Halves a height map: 2x2 cells become one. The mean is taken of those valid cells only that lie
// near the highest of the four, so that nothing is averaged across a step and a contour does not
// turn into a ramp of heights that nobody measured.

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/rectify/height_map.hpp"

namespace flatpose::image {

/// Cells along one axis after halving; an odd last cell keeps a cell of its own.
[[nodiscard]] constexpr int halved(int size_px) noexcept { return (size_px + 1) / 2; }

/// Where the cells of the halved map lie: coarse cell i covers the fine cells 2i and 2i + 1, so its
/// centre is at fine column 2i + 0.5 (and fine column c at coarse column (c - 0.5) / 2).
[[nodiscard]] rectify::Grid halved(const rectify::Grid& grid) noexcept;

/// Writes the mean of the valid ones of each 2x2 cells that lie at most `jump_mm` below the
/// highest; NaN where none is valid. Shape: `coarse_mm` is halved(width) x halved(height).  Units:
/// mm.  Cost: one pass, linear. Memory: none.  Fails: kShapeMismatch, kInvalidArgument (jump_mm < 0
/// or NaN).  Thread: reentrant.
Status halve(ImageView<const float> fine_mm, float jump_mm, ImageView<float> coarse_mm,
             VectorPath path = VectorPath::kPortable) noexcept;

}  // namespace flatpose::image
