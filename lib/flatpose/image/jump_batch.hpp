#pragma once
// Jumps tested and measured many at a time. The loops are in row_kernels.hpp.
//
// A jump is the top of a ridge of slopes: at its cell the height falls more steeply, the surface's
// own slope taken off, than one cell before and after it along the direction of the fall.

#include <cstdint>

#include "flatpose/image/slope_field.hpp"

namespace flatpose::image {

/// Cells over which a step may be smeared and still count with its full height.
inline constexpr float kSmear_px = 3.0F;
/// Distance at which the slope beside an edge is read, beyond the reach of Sobel's corners.
inline constexpr int kBeside_px = 3;

/// A slope field as the loops read it.
struct JumpField {
  const float* height_mm;
  const float* slope_x;
  const float* slope_y;
  const std::uint8_t* missing;
  std::int32_t height_stride_px;
  std::int32_t slope_stride_px;
  std::int32_t missing_stride_px;
  std::int32_t width_px;  ///< At least 3, as the height.
  std::int32_t height_px;

  explicit JumpField(const SlopeField& field) noexcept
      : height_mm(field.height_mm.data),
        slope_x(field.slope_x.data),
        slope_y(field.slope_y.data),
        missing(field.missing.data),
        height_stride_px(static_cast<std::int32_t>(field.height_mm.stride_px)),
        slope_stride_px(static_cast<std::int32_t>(field.slope_x.stride_px)),
        missing_stride_px(static_cast<std::int32_t>(field.missing.stride_px)),
        width_px(field.height_mm.width_px),
        height_px(field.height_mm.height_px) {}
};

/// Cells to be tested or measured, and what came out. None of them lies on the outermost ring.
struct JumpBatch {
  static constexpr int kCountMax = 256;
  static constexpr int kPadding = 16;  ///< As much as the widest vector may touch beyond.
  static constexpr int kSize = kCountMax + kPadding;

  int count = 0;
  std::int32_t column[kSize];
  std::int32_t row[kSize];

  /// How far the height jumps; 0 where the cell is no top of a ridge, or falls from a missing cell.
  /// When measured: never below 0.
  float step_mm[kSize];
  // Of those tested that jump:
  std::int32_t below_is_missing[kSize];  ///< -1: yes, 0: no.
  // Of those measured:
  float x_px[kSize];
  float y_px[kSize];
  float fall_x[kSize];
  float fall_y[kSize];

  void add(int column_, int row_) noexcept {
    column[count] = column_;
    row[count] = row_;
    ++count;
  }
  /// What the last vector reads beyond the end becomes a cell like any other.
  void pad() noexcept {
    for (int i = 0; i < kPadding; ++i) column[count + i] = row[count + i] = 1;
  }
};

}  // namespace flatpose::image
