#pragma once
// The 3x3 Sobel operator: slopes of a height map, averaged (1 2 1) across the direction of the
// derivative. The image goes on with its border cells' values, so on the outermost ring the slope
// across the border comes out at half its size.

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// Writes the derivatives of `height_mm` along columns (x) and rows (y); NaN where any of the 3x3
/// cells is NaN.
/// Shape: all three alike; no overlap.  Units: mm per cell.  Cost: one pass, linear in cells.
/// Memory: none.  Fails: kShapeMismatch.  Thread: reentrant.
Status sobel(ImageView<const float> height_mm, ImageView<float> slope_x, ImageView<float> slope_y,
             VectorPath path = VectorPath::kPortable) noexcept;

}  // namespace flatpose::image
