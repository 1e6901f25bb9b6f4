#include "bench/speed/load_roof.hpp"

namespace flatpose::bench {

void load_all_portable(const std::uint8_t* first, std::size_t size_bytes);
void load_all_avx2(const std::uint8_t* first, std::size_t size_bytes);
void load_all_avx512(const std::uint8_t* first, std::size_t size_bytes);

LoadAll load_all_for(VectorPath path) {
  if (path == VectorPath::kAvx2) return load_all_avx2;
  if (path == VectorPath::kAvx512) return load_all_avx512;
  return load_all_portable;
}

}  // namespace flatpose::bench
