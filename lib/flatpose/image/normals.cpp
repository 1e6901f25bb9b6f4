#include "flatpose/image/normals.hpp"

#include <algorithm>

#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

// The ring takes its inner neighbour's value, so that a plane has one normal everywhere; that
// neighbour's 3x3 cells hold the ring cell's own, so nothing missing is lost.
void copy_sides(int width_px, float* row) noexcept {
  if (width_px < 3) return;
  row[0] = row[1];
  row[width_px - 1] = row[width_px - 2];
}

void copy_ends(ImageView<float> image) noexcept {
  const int h = image.height_px;
  if (h < 3) return;
  std::copy_n(image.row(1), image.width_px, image.row(0));
  std::copy_n(image.row(h - 2), image.width_px, image.row(h - 1));
}

}  // namespace

Status check_normal_map(ImageView<const float> height_mm, double cell_mm, ImageView<float> normal_x,
                        ImageView<float> normal_y) noexcept {
  if (!(cell_mm > 0.0) || !std::isfinite(cell_mm)) return Status::kInvalidArgument;
  return same_shape(height_mm, normal_x) && same_shape(height_mm, normal_y)
             ? Status::kOk
             : Status::kShapeMismatch;
}

void write_normals(ImageView<const float> height_mm, double cell_mm, ImageView<float> normal_x,
                   ImageView<float> normal_y, int row_begin, int row_end,
                   VectorPath path) noexcept {
  const RowKernels& kernels = row_kernels(path);
  const int w = height_mm.width_px;
  // Two cells in a row have but one difference, which the repeated border halves.
  const float per_mm = static_cast<float>(1.0 / cell_mm);
  const float scale_x = w == 2 ? 2.0F * per_mm : per_mm;
  const float scale_y = height_mm.height_px == 2 ? 2.0F * per_mm : per_mm;
  for (int y = row_begin; y < row_end; ++y) {
    float* const x = normal_x.row(y);
    float* const down = normal_y.row(y);
    kernels.sobel(three_rows(height_mm, y), w, x, down);
    kernels.normalise(scale_x, scale_y, w, x, down);
    copy_sides(w, x);
    copy_sides(w, down);
  }
}

void close_normals(ImageView<float> normal_x, ImageView<float> normal_y) noexcept {
  copy_ends(normal_x);
  copy_ends(normal_y);
}

Status normal_map(ImageView<const float> height_mm, double cell_mm, ImageView<float> normal_x,
                  ImageView<float> normal_y, VectorPath path) noexcept {
  const Status status = check_normal_map(height_mm, cell_mm, normal_x, normal_y);
  if (status != Status::kOk || height_mm.empty()) return status;
  write_normals(height_mm, cell_mm, normal_x, normal_y, 0, height_mm.height_px, path);
  close_normals(normal_x, normal_y);
  return Status::kOk;
}

}  // namespace flatpose::image
