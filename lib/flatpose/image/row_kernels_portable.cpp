#define FLATPOSE_LANES 4
#include "flatpose/image/row_kernels.inc"

namespace flatpose::image {
const RowKernels kPortableRowKernels = {carry_down,       carry_up,   sobel,        normalise,
                                        mark_jumps,       drop_weak,  halve,        shorten_forward,
                                        shorten_backward, test_jumps, measure_jumps};
}  // namespace flatpose::image
