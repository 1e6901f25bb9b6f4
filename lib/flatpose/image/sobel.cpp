#include "flatpose/image/sobel.hpp"

#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {

Status sobel(ImageView<const float> height_mm, ImageView<float> slope_x, ImageView<float> slope_y,
             VectorPath path) noexcept {
  if (!same_shape(height_mm, slope_x) || !same_shape(height_mm, slope_y)) {
    return Status::kShapeMismatch;
  }
  if (height_mm.empty()) return Status::kOk;
  const RowKernels& kernels = row_kernels(path);
  for (int y = 0; y < height_mm.height_px; ++y)
    kernels.sobel(three_rows(height_mm, y), height_mm.width_px, slope_x.row(y), slope_y.row(y));
  return Status::kOk;
}

}  // namespace flatpose::image
