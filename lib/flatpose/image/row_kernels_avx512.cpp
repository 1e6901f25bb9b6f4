#define FLATPOSE_LANES 16
#include "flatpose/image/row_kernels.inc"

namespace flatpose::image {
const RowKernels kAvx512RowKernels = kRowKernels;
}  // namespace flatpose::image
