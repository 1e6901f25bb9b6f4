#define FLATPOSE_LANES 4
#include "flatpose/rectify/row_kernels.inc"

namespace flatpose::rectify {
const RowKernels kPortableRowKernels = {transform_row, covers_any, find_cells};
}  // namespace flatpose::rectify
