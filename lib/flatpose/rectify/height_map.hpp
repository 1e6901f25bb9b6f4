#pragma once
// An orthographic height map: heights along z of the work frame, sampled on a regular grid of x and
// y.

#include <cstdint>

#include "flatpose/core/image_view.hpp"

namespace flatpose::rectify {

/// Where the cells lie. Column runs with x, row with y.
struct Grid {
  double x0_mm = 0.0;  ///< x of the centre of cell (0, 0).
  double y0_mm = 0.0;
  double cell_mm = 1.0;  ///< Side of a cell.
  int width_px = 0;
  int height_px = 0;

  [[nodiscard]] double column_of(double x_mm) const noexcept { return (x_mm - x0_mm) / cell_mm; }
  [[nodiscard]] double row_of(double y_mm) const noexcept { return (y_mm - y0_mm) / cell_mm; }
  [[nodiscard]] double x_of(double column) const noexcept { return x0_mm + column * cell_mm; }
  [[nodiscard]] double y_of(double row) const noexcept { return y0_mm + row * cell_mm; }
};

/// Some of a grid's cells; half-open.
struct CellWindow {
  std::int32_t column_begin = 0;
  std::int32_t column_end = 0;
  std::int32_t row_begin = 0;
  std::int32_t row_end = 0;
};

[[nodiscard]] inline CellWindow whole(const Grid& grid) noexcept {
  return {0, grid.width_px, 0, grid.height_px};
}

inline constexpr std::int32_t kNoSource = -1;

struct HeightMap {
  Grid grid;
  ImageView<float> height_mm;            ///< NaN where nothing was seen.
  ImageView<std::int32_t> source_index;  ///< row * width_px + column of the scan's pixel that fed
                                         ///< the cell, or kNoSource.
};

}  // namespace flatpose::rectify
