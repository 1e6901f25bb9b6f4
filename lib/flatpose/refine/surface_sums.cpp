#include "flatpose/refine/surface_sums.hpp"

namespace flatpose::refine {

SumSurface sum_surface_for(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, kPortableSumSurface, kAvx2SumSurface, kAvx512SumSurface);
}

}  // namespace flatpose::refine
