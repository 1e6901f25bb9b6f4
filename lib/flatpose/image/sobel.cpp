#include "flatpose/image/sobel.hpp"

namespace flatpose::image {
namespace {

struct Rows {
  const float* above;
  const float* here;
  const float* below;
};

inline Vec2f slope_at(const Rows& r, int left, int x, int right) noexcept {
  const float down = r.below[left] + 2.0F * r.below[x] + r.below[right];
  const float up = r.above[left] + 2.0F * r.above[x] + r.above[right];
  const float east = r.above[right] + 2.0F * r.here[right] + r.below[right];
  const float west = r.above[left] + 2.0F * r.here[left] + r.below[left];
  // Zero, or NaN when a cell is missing whose own weight is zero.
  const float missing = 0.0F * (down + up + r.here[left] + r.here[x] + r.here[right]);
  return {0.125F * (east - west) + missing, 0.125F * (down - up) + missing};
}

// Calls put(x, left, right) for each cell of a row, the border's cells being their own neighbours.
template <class Put>
void for_each_cell(int width_px, const Put& put) noexcept {
  const int last = width_px - 1;
  put(0, 0, last > 0 ? 1 : 0);
  for (int x = 1; x < last; ++x) put(x, x - 1, x + 1);
  if (last > 0) put(last, last - 1, last);
}

Rows rows_at(ImageView<const float> height_mm, int y) noexcept {
  const int last = height_mm.height_px - 1;
  return {height_mm.row(y > 0 ? y - 1 : 0), height_mm.row(y), height_mm.row(y < last ? y + 1 : y)};
}

void sobel_row(const Rows& rows, int width_px, float* __restrict slope_x,
               float* __restrict slope_y) noexcept {
  for_each_cell(width_px, [&](int x, int left, int right) {
    const Vec2f s = slope_at(rows, left, x, right);
    slope_x[x] = s.x;
    slope_y[x] = s.y;
  });
}

void sobel_row(const Rows& rows, int width_px, Vec2f* __restrict slope) noexcept {
  for_each_cell(width_px,
                [&](int x, int left, int right) { slope[x] = slope_at(rows, left, x, right); });
}

}  // namespace

Status sobel(ImageView<const float> height_mm, ImageView<float> slope_x,
             ImageView<float> slope_y) noexcept {
  if (!same_shape(height_mm, slope_x) || !same_shape(height_mm, slope_y)) {
    return Status::kShapeMismatch;
  }
  if (height_mm.empty()) return Status::kOk;
  for (int y = 0; y < height_mm.height_px; ++y)
    sobel_row(rows_at(height_mm, y), height_mm.width_px, slope_x.row(y), slope_y.row(y));
  return Status::kOk;
}

Status sobel(ImageView<const float> height_mm, ImageView<Vec2f> slope) noexcept {
  if (!same_shape(height_mm, slope)) return Status::kShapeMismatch;
  if (height_mm.empty()) return Status::kOk;
  for (int y = 0; y < height_mm.height_px; ++y)
    sobel_row(rows_at(height_mm, y), height_mm.width_px, slope.row(y));
  return Status::kOk;
}

}  // namespace flatpose::image
