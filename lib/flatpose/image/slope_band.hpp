#pragma once
// The slopes of some rows of a height map: few enough to stay near the processor. Beyond the ring
// of border cells, where Sobel is wrong, the slopes of its inner neighbours go on.

#include <cstdint>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

struct SlopeBand {
  static constexpr int kHalo_px = 8;     ///< Rows that may be read to both sides of a cell's.
  static constexpr int kMargin_px = 16;  ///< Columns likewise, and what a vector reads beyond.

  float* x = nullptr;  ///< mm per cell.
  float* y = nullptr;
  float* xy = nullptr;  ///< Both side by side, for those who look here and there.
  std::int32_t stride_px = 0;
  std::int32_t row_begin = 0;  ///< Rows of the map; may lie outside it.
  std::int32_t row_end = 0;

  /// Takes memory for `row_count` rows of a map of this width.
  static SlopeBand take(Arena& arena, int width_px, int row_count) noexcept;

  /// Where the slope of cell (0, 0) is, or would be.
  [[nodiscard]] std::int32_t origin() const noexcept { return kMargin_px - row_begin * stride_px; }
  [[nodiscard]] float* x_row(int row) const noexcept { return x + origin() + row * stride_px; }
  [[nodiscard]] float* y_row(int row) const noexcept { return y + origin() + row * stride_px; }

  /// Works out the slopes of some rows of a map of at least 3 x 3 cells, some of which lie on it.
  void fill(ImageView<const float> height_mm, int row_begin, int row_end, VectorPath path) noexcept;
};

}  // namespace flatpose::image
