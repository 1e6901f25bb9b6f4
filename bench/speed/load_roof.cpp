#include "bench/speed/load_roof.hpp"

namespace flatpose::bench {

void load_all_portable(const std::uint8_t* first, std::size_t size_bytes);
void load_all_avx2(const std::uint8_t* first, std::size_t size_bytes);
void load_all_avx512(const std::uint8_t* first, std::size_t size_bytes);

LoadAll load_all_for(VectorPath path) {
  return FLATPOSE_FORM_FOR(path, load_all_portable, load_all_avx2, load_all_avx512);
}

}  // namespace flatpose::bench
