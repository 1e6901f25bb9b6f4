#pragma once
// Jumps tested and measured many at a time. The loops are in row_kernels.hpp.
//
// A jump is the top of a ridge of slopes: at its cell the height falls more steeply, the surface's
// own slope taken off, than one cell before and after it along the direction of the fall.

#include <cstdint>

#include "flatpose/image/slope_band.hpp"

namespace flatpose::image {

/// Cells over which a step may be smeared and still count with its full height.
inline constexpr float kSmear_px = 3.0F;
/// Distance at which the slope beside an edge is read, beyond the reach of Sobel's corners.
inline constexpr int kBeside_px = 3;

/// A height map and a band of its slopes as the loops read them.
struct JumpField {
  const float* height_mm;
  const std::uint8_t* missing;
  std::int32_t height_stride_px;
  std::int32_t missing_stride_px;
  std::int32_t width_px;  ///< At least 3, as the height.
  std::int32_t height_px;
  const float* slope_x;
  const float* slope_y;
  const float* slope_xy;  ///< Both side by side, 2 floats a cell.
  std::int32_t slope_stride_px;
  std::int32_t slope_origin;  ///< Where the slope of cell (0, 0) is, or would be.
  std::int32_t slope_row_begin;
  std::int32_t slope_row_end;

  JumpField(ImageView<const float> height, ImageView<const std::uint8_t> missing_,
            const SlopeBand& slopes) noexcept
      : height_mm(height.data),
        missing(missing_.data),
        height_stride_px(static_cast<std::int32_t>(height.stride_px)),
        missing_stride_px(static_cast<std::int32_t>(missing_.stride_px)),
        width_px(height.width_px),
        height_px(height.height_px),
        slope_x(slopes.x),
        slope_y(slopes.y),
        slope_xy(slopes.xy),
        slope_stride_px(slopes.stride_px),
        slope_origin(slopes.origin()),
        slope_row_begin(slopes.row_begin),
        slope_row_end(slopes.row_end) {}
};

/// Cells that may be jumps, those of them that are, and what these measure. None lies on the
/// outermost ring; all are at least SlopeBand::kHalo_px from the rows where the band is cut off.
struct JumpBatch {
  static constexpr int kCountMax = 256;
  static constexpr int kPadding = 16;  ///< As much as the widest vector may touch beyond.
  static constexpr int kSize = kCountMax + kPadding;

  int count = 0;
  std::int32_t column[kSize];
  std::int32_t row[kSize];

  // Of those that are tops of ridges and jump far enough, in the order of the cells:
  int jump_count = 0;
  std::int32_t index[kSize];             ///< Of the cell.
  std::int32_t below_is_missing[kSize];  ///< -1: yes, 0: no.
  float tested_step_mm[kSize];
  float fall_x[kSize];  ///< Unit direction; more exact when measured.
  float fall_y[kSize];
  // When measured:
  float x_px[kSize];
  float y_px[kSize];
  float step_mm[kSize];  ///< How far the height jumps; never below 0.

  void add(int column_, int row_) noexcept {
    column[count] = column_;
    row[count] = row_;
    ++count;
  }
  /// What the last vector reads beyond the end becomes a cell like any other.
  void pad() noexcept {
    for (int i = 0; i < kPadding; ++i) {
      column[count + i] = column[0];
      row[count + i] = row[0];
    }
  }
};

}  // namespace flatpose::image
