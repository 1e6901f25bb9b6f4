#define FLATPOSE_LANES 4
#include "flatpose/image/row_kernels.inc"

namespace flatpose::image {
const RowKernels kPortableRowKernels = {carry_down,
                                        carry_up,
                                        count_single,
                                        find_wide,
                                        sobel,
                                        interleave,
                                        normalise,
                                        mark_jumps,
                                        halve,
                                        shorten_forward,
                                        shorten_backward,
                                        shorten_bytes_forward,
                                        shorten_bytes_backward,
                                        test_jumps,
                                        measure_jumps};
}  // namespace flatpose::image
