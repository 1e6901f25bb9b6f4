#define FLATPOSE_LANES 8
#include "flatpose/search/tilt_rows.inc"

namespace flatpose::search {
const TiltKernels kAvx2TiltKernels = {sum_row, fit_row};
}  // namespace flatpose::search
