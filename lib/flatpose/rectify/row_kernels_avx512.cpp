#define FLATPOSE_LANES 16
#include "flatpose/rectify/row_kernels.inc"

namespace flatpose::rectify {
const RowKernels kAvx512RowKernels = kRowKernels;
}  // namespace flatpose::rectify
