#define FLATPOSE_LANES 4
#include "flatpose/search/tilt_rows.inc"

namespace flatpose::search {
const TiltKernels kPortableTiltKernels = {sum_row, fit_row};
}  // namespace flatpose::search
