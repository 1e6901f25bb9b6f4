#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {

const RowKernels& row_kernels(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, kPortableRowKernels, kAvx2RowKernels, kAvx512RowKernels);
}

}  // namespace flatpose::image
