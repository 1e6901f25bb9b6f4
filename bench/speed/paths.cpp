#include "bench/speed/paths.hpp"

#include "port/linux/cpu/vector_path.hpp"

namespace flatpose::bench {

const std::vector<NamedPath>& vector_paths() {
  static const std::vector<NamedPath> paths = [] {
    const std::vector<NamedPath> all{{"portable", VectorPath::kPortable},
                                     {"avx2", VectorPath::kAvx2},
                                     {"avx512", VectorPath::kAvx512}};
    return std::vector<NamedPath>(all.begin(),
                                  all.begin() + static_cast<int>(port::best_vector_path()) + 1);
  }();
  return paths;
}

}  // namespace flatpose::bench
