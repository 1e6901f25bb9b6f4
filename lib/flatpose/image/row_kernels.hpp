#pragma once
// The loops of this room that run over all cells, or over many edges side by side. Their text is
// compiled once for every vector width; all give the same bits.

#include <cstdint>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/image/jump_batch.hpp"
#include "flatpose/image/octant_image.hpp"

namespace flatpose::image {

/// Marks of a cell at which there may be an edge.
inline constexpr std::uint8_t kMaybeJump = 1;
inline constexpr std::uint8_t kMaybeCrease = 2;

/// Three rows of a height map, one below the other.
struct ThreeRows {
  const float* above;
  const float* here;
  const float* below;
};

/// Row y of an image and those beside it; the border's rows are their own neighbours.
[[nodiscard]] inline ThreeRows three_rows(ImageView<const float> image, int y) noexcept {
  const int last = image.height_px - 1;
  return {image.row(y > 0 ? y - 1 : 0), image.row(y), image.row(y < last ? y + 1 : y)};
}

struct RowKernels {
  /// Marks what is missing of a row; such cells take what is carried, all others are carried on
  /// and lower what is the lowest of their columns. `filled_mm` may be `height_mm`. Returns whether
  /// any was missing.
  bool (*carry_down)(const float* height_mm, int width_px, float* carried, float* lowest_mm,
                     float* filled_mm, std::uint8_t* missing) noexcept;
  /// What is not missing is carried on.
  void (*carry_up)(const std::uint8_t* missing, const float* filled_mm, int width_px,
                   float* carried) noexcept;
  /// How many cells of a row, the border left out, are missing alone.
  int (*count_single)(const std::uint8_t* above, const std::uint8_t* here,
                      const std::uint8_t* below, int width_px) noexcept;
  /// Tells of each cell whether it and the next ones, `least_px` in all, are missing; returns
  /// whether any is.
  bool (*find_wide)(const std::uint8_t* missing, int width_px, int least_px,
                    std::uint8_t* wide) noexcept;
  /// Sobel's slopes of the middle row.
  void (*sobel)(const ThreeRows& height_mm, int width_px, float* slope_x, float* slope_y) noexcept;
  /// Puts the numbers of two rows side by side.
  void (*interleave)(const float* first, const float* second, int count, float* pairs) noexcept;
  /// Turns slopes into the first two components of unit normals.
  void (*normalise)(float scale_x, float scale_y, int width_px, float* x, float* y) noexcept;
  /// Marks the cells at which the slope, less that of both sides, is at least `least`; rows are
  /// kBeside_px apart, held off the border. Clears the marks of all others.
  void (*mark_jumps)(const float* slope_x, const ThreeRows& slope_y, int width_px, float least,
                     std::uint8_t* marks) noexcept;

  /// Makes one cell of two by two of two rows: the mean of those at most `jump_mm` below the
  /// highest. An odd last cell is halved with itself.
  void (*halve)(const float* top, const float* bottom, int width_px, float jump_mm,
                float* out) noexcept;
  /// Shorten the chamfer distances of a row by way of the finished row before it, which may be the
  /// row itself, and of the cell to the left, or to the right.
  void (*shorten_forward)(const OctantCell* previous, int width_px, OctantCell* row) noexcept;
  void (*shorten_backward)(const OctantCell* previous, int width_px, OctantCell* row) noexcept;

  /// The same of one byte a cell.
  void (*shorten_bytes_forward)(const std::uint8_t* previous, int width_px,
                                std::uint8_t* row) noexcept;
  void (*shorten_bytes_backward)(const std::uint8_t* previous, int width_px,
                                 std::uint8_t* row) noexcept;

  /// Finds the cells of a batch that are jumps of at least `jump_low_mm`; measures those found.
  void (*test_jumps)(const JumpField& field, float jump_low_mm, JumpBatch& batch) noexcept;
  void (*measure_jumps)(const JumpField& field, JumpBatch& batch) noexcept;
};

/// The loops for a path; the portable ones where this build has no other.
[[nodiscard]] const RowKernels& row_kernels(VectorPath path) noexcept;

/// Those that exist: reached through row_kernels() alone.
extern const RowKernels kPortableRowKernels;
extern const RowKernels kAvx2RowKernels;
extern const RowKernels kAvx512RowKernels;

}  // namespace flatpose::image
