#define FLATPOSE_LANES 8
#include "flatpose/rectify/row_kernels.inc"

namespace flatpose::rectify {
const RowKernels kAvx2RowKernels = {transform_row, covers_any, find_cells};
}  // namespace flatpose::rectify
