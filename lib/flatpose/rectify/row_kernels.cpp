#include "flatpose/rectify/row_kernels.hpp"

namespace flatpose::rectify {

const RowKernels& row_kernels(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, kPortableRowKernels, kAvx2RowKernels, kAvx512RowKernels);
}

}  // namespace flatpose::rectify
