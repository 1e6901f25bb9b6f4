#define FLATPOSE_LANES 8
#include "flatpose/refine/surface_sums.inc"

namespace flatpose::refine {
const SumSurface kAvx512SumSurface = sum_surface;
}  // namespace flatpose::refine
