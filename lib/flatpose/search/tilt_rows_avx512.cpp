#define FLATPOSE_LANES 16
#include "flatpose/search/tilt_rows.inc"

namespace flatpose::search {
const TiltKernels kAvx512TiltKernels = {sum_row, fit_row};
}  // namespace flatpose::search
