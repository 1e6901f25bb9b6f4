#pragma once
// The normal map: which way the surface faces at every cell (Ingberg 2015, sec. 2.6.2).
//
// With heights z(x, y) the upward normal is (-dz/dx, -dz/dy, 1), normalised. The Sobel sums of eq.
// 2.8 are 8 times the slope per cell, so the vector is (-Sx, -Sy, 8 k), k the side of a cell; the
// printed (Sx, Sy, 4 k) has the other sign and twice the slope, and a tilted plane comes out wrong.
// Cells on the outermost ring take the slope of their inner neighbour, because Sobel halves it
// there.

#include <cmath>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// Writes x and y of the unit normal, z being positive; NaN where any of the 3x3 heights is
/// missing. Shape: all three alike; no overlap.  Units: heights and `cell_mm` in mm, normals of
/// length 1. Cost: one pass, linear in cells.  Memory: none. Fails: kShapeMismatch,
/// kInvalidArgument (cell_mm not positive).  Thread: reentrant.
Status normal_map(ImageView<const float> height_mm, double cell_mm, ImageView<float> normal_x,
                  ImageView<float> normal_y, VectorPath path = VectorPath::kPortable) noexcept;

/// normal_map() in parts, for several to write: first the check, then all rows, at last the ring.
[[nodiscard]] Status check_normal_map(ImageView<const float> height_mm, double cell_mm,
                                      ImageView<float> normal_x,
                                      ImageView<float> normal_y) noexcept;
void write_normals(ImageView<const float> height_mm, double cell_mm, ImageView<float> normal_x,
                   ImageView<float> normal_y, int row_begin, int row_end, VectorPath path) noexcept;
void close_normals(ImageView<float> normal_x, ImageView<float> normal_y) noexcept;

/// The third component of a normal kept as its first two.
[[nodiscard]] inline float normal_z(float normal_x, float normal_y) noexcept {
  const float rest = 1.0F - normal_x * normal_x - normal_y * normal_y;
  return std::sqrt(rest > 0.0F ? rest : 0.0F * rest);
}

}  // namespace flatpose::image
