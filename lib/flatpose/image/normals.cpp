#include "flatpose/image/normals.hpp"

#include <algorithm>

#include "flatpose/image/sobel.hpp"

namespace flatpose::image {
namespace {

void normalise_row(int width_px, float scale_x, float scale_y, float* __restrict nx,
                   float* __restrict ny) noexcept {
  for (int x = 0; x < width_px; ++x) {
    const float a = nx[x] * scale_x;
    const float b = ny[x] * scale_y;
    const float length = std::sqrt(1.0F + a * a + b * b);
    nx[x] = -a / length;
    ny[x] = -b / length;
  }
}

// The ring takes its inner neighbour's value, so that a plane has one normal everywhere; that
// neighbour's 3x3 cells hold the ring cell's own, so nothing missing is lost.
void copy_ring(ImageView<float> image) noexcept {
  const int w = image.width_px;
  const int h = image.height_px;
  if (w >= 3) {
    for (int y = 0; y < h; ++y) {
      image(0, y) = image(1, y);
      image(w - 1, y) = image(w - 2, y);
    }
  }
  if (h >= 3) {
    std::copy_n(image.row(1), w, image.row(0));
    std::copy_n(image.row(h - 2), w, image.row(h - 1));
  }
}

}  // namespace

Status normal_map(ImageView<const float> height_mm, double cell_mm, ImageView<float> normal_x,
                  ImageView<float> normal_y) noexcept {
  if (!(cell_mm > 0.0) || !std::isfinite(cell_mm)) return Status::kInvalidArgument;
  const Status status = sobel(height_mm, normal_x, normal_y);
  if (status != Status::kOk || height_mm.empty()) return status;
  copy_ring(normal_x);
  copy_ring(normal_y);
  const int w = height_mm.width_px;
  const int h = height_mm.height_px;
  // Two cells in a row have but one difference, which the repeated border halves.
  const float per_mm = static_cast<float>(1.0 / cell_mm);
  const float scale_x = w == 2 ? 2.0F * per_mm : per_mm;
  const float scale_y = h == 2 ? 2.0F * per_mm : per_mm;
  for (int y = 0; y < h; ++y) normalise_row(w, scale_x, scale_y, normal_x.row(y), normal_y.row(y));
  return Status::kOk;
}

}  // namespace flatpose::image
