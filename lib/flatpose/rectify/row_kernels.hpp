#pragma once
// The loops over all points and quads of a scan. Their text is compiled once for every vector
// width; all give the same bits.

#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/extent.hpp"
#include "flatpose/rectify/quad_strip.hpp"
#include "flatpose/rectify/scan_row.hpp"

namespace flatpose::rectify {

struct RowKernels {
  /// Adds the points of row `row` to count and box.
  void (*add_extent)(const RangeImageView& scan, int row, const Affine& work_T_scan,
                     Extent& extent) noexcept;
  /// Transforms row `row` of `scan` into `out`, which is as wide.
  void (*transform_row)(const ScanToGrid& to_grid, const RangeImageView& scan, int row,
                        const ScanRow& out) noexcept;
  /// Paints the quads of a strip that hold one cell's centre; those that may hold more, or are
  /// folded, are appended to `several`.
  void (*paint_single_cells)(const QuadStrip& strip, const EdgeLimits& limits,
                             const MapCells& cells, QuadList& several) noexcept;
  /// Paints the first diagonal's triangles of those that hold up to three by three; the others are
  /// appended to `rest`.
  void (*paint_several_cells)(const QuadStrip& strip, const MapCells& cells,
                              const QuadList& several, QuadList& rest) noexcept;
};

/// The loops for a path; the portable ones where this build has no other.
[[nodiscard]] const RowKernels& row_kernels(VectorPath path) noexcept;

/// Those that exist: reached through row_kernels() alone.
extern const RowKernels kPortableRowKernels;
extern const RowKernels kAvx2RowKernels;
extern const RowKernels kAvx512RowKernels;

}  // namespace flatpose::rectify
