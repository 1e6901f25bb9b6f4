#define FLATPOSE_LANES 8
#include "flatpose/image/row_kernels.inc"

namespace flatpose::image {
const RowKernels kAvx2RowKernels = kRowKernels;
}  // namespace flatpose::image
