#define FLATPOSE_LANES 4
#include "flatpose/rectify/row_kernels.inc"

namespace flatpose::rectify {
const RowKernels kPortableRowKernels = kRowKernels;
}  // namespace flatpose::rectify
