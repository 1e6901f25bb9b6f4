#pragma once
// An organized range image as the sensor delivers it: x, y, z in mm at every pixel of a grid, NaN
// where missing. A view with strides, so that interleaved clouds, separate planes and padded points
// are all read where they stand.

#include <cmath>
#include <cstddef>

#include "flatpose/geometry/vec3.hpp"

namespace flatpose {

struct RangeImageView {
  const float* x_mm = nullptr;
  const float* y_mm = nullptr;
  const float* z_mm = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::ptrdiff_t pixel_stride_bytes = 0;  ///< From a value to the next in its row; a multiple of 4.
  std::ptrdiff_t row_stride_bytes = 0;    ///< From a value to the one below it; a multiple of 4.

  [[nodiscard]] Vec3 operator()(int column, int row) const noexcept {
    const std::ptrdiff_t offset_bytes = row * row_stride_bytes + column * pixel_stride_bytes;
    return {at(x_mm, offset_bytes), at(y_mm, offset_bytes), at(z_mm, offset_bytes)};
  }
  [[nodiscard]] bool contains(int column, int row) const noexcept {
    return column >= 0 && row >= 0 && column < width_px && row < height_px;
  }
  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  }

 private:
  static double at(const float* base, std::ptrdiff_t offset_bytes) noexcept {
    return static_cast<double>(
        *reinterpret_cast<const float*>(reinterpret_cast<const char*>(base) + offset_bytes));
  }
};

/// A point counts only when all three coordinates are finite.
[[nodiscard]] inline bool is_valid(const Vec3& p_mm) noexcept {
  return std::isfinite(p_mm.x) && std::isfinite(p_mm.y) && std::isfinite(p_mm.z);
}

}  // namespace flatpose
