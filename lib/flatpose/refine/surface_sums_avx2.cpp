#define FLATPOSE_LANES 4
#include "flatpose/refine/surface_sums.inc"

namespace flatpose::refine {
const SumSurface kAvx2SumSurface = sum_surface;
}  // namespace flatpose::refine
