#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {

const RowKernels& row_kernels(VectorPath path) noexcept {
#ifdef FLATPOSE_X86_PATHS
  if (path == VectorPath::kAvx512) return kAvx512RowKernels;
  if (path == VectorPath::kAvx2) return kAvx2RowKernels;
#endif
  (void)path;
  return kPortableRowKernels;
}

}  // namespace flatpose::image
