#include "port/linux/cpu/vector_path.hpp"

namespace flatpose::port {

VectorPath best_vector_path() noexcept {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw"))
    return VectorPath::kAvx512;
  if (__builtin_cpu_supports("avx2")) return VectorPath::kAvx2;
#endif
  return VectorPath::kPortable;
}

}  // namespace flatpose::port
