#pragma once
// The loops over all points and quads of a scan. Their text is compiled once for every vector
// width; all give the same bits.

#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/quad_block.hpp"
#include "flatpose/rectify/scan_row.hpp"

namespace flatpose::rectify {

struct RowKernels {
  /// Transforms row `row` of `scan` into `out`, which is as wide.
  void (*transform_row)(const ScanToGrid& to_grid, const RangeImageView& scan, int row,
                        const ScanRow& out) noexcept;
  /// False when no quad of the block can hold a cell's centre.
  bool (*covers_any)(const QuadBlock& block) noexcept;
  /// Finds what each quad of the block does to the map.
  void (*find_cells)(const QuadBlock& block, const EdgeLimits& limits, const Grid& grid,
                     BlockFindings& out) noexcept;
};

/// The loops for a path; the portable ones where this build has no other.
[[nodiscard]] const RowKernels& row_kernels(VectorPath path) noexcept;

/// Those that exist: reached through row_kernels() alone.
extern const RowKernels kPortableRowKernels;
extern const RowKernels kAvx2RowKernels;
extern const RowKernels kAvx512RowKernels;

}  // namespace flatpose::rectify
