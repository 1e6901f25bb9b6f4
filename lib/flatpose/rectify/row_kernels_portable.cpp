#define FLATPOSE_LANES 4
#include "flatpose/rectify/row_kernels.inc"

namespace flatpose::rectify {
const RowKernels kPortableRowKernels = {add_extent, transform_row, paint_single_cells,
                                        paint_several_cells};
}  // namespace flatpose::rectify
