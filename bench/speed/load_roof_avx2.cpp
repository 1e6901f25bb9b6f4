#include "bench/speed/load_roof.hpp"
#define FLATPOSE_LANES 32
#include "bench/speed/load_roof.inc"

namespace flatpose::bench {
void load_all_avx2(const std::uint8_t* first, std::size_t size_bytes) {
  load_all(first, size_bytes);
}
}  // namespace flatpose::bench
