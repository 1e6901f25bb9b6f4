#define FLATPOSE_LANES 8
#include "flatpose/rectify/row_kernels.inc"

namespace flatpose::rectify {
const RowKernels kAvx2RowKernels = kRowKernels;
}  // namespace flatpose::rectify
