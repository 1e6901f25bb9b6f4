#include "flatpose/image/pyramid.hpp"

#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {

rectify::Grid halved(const rectify::Grid& grid) noexcept {
  return {grid.x_of(0.5), grid.y_of(0.5), 2.0 * grid.cell_mm, halved(grid.width_px),
          halved(grid.height_px)};
}

Status halve(ImageView<const float> fine_mm, float jump_mm, ImageView<float> coarse_mm,
             VectorPath path) noexcept {
  if (!(jump_mm >= 0.0F)) return Status::kInvalidArgument;
  if (coarse_mm.width_px != halved(fine_mm.width_px) ||
      coarse_mm.height_px != halved(fine_mm.height_px)) {
    return Status::kShapeMismatch;
  }
  const RowKernels& kernels = row_kernels(path);
  for (int y = 0; y < coarse_mm.height_px; ++y) {
    const float* top = fine_mm.row(2 * y);
    // An odd last row is its own partner: counting each of its cells twice leaves their mean.
    const float* bottom = 2 * y + 1 < fine_mm.height_px ? fine_mm.row(2 * y + 1) : top;
    kernels.halve(top, bottom, fine_mm.width_px, jump_mm, coarse_mm.row(y));
  }
  return Status::kOk;
}

}  // namespace flatpose::image
