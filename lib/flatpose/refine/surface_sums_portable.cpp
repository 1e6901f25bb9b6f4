#define FLATPOSE_LANES 2
#include "flatpose/refine/surface_sums.inc"

namespace flatpose::refine {
const SumSurface kPortableSumSurface = sum_surface;
}  // namespace flatpose::refine
