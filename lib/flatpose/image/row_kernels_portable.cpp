#define FLATPOSE_LANES 4
#include "flatpose/image/row_kernels.inc"

namespace flatpose::image {
const RowKernels kPortableRowKernels = kRowKernels;
}  // namespace flatpose::image
