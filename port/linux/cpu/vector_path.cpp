#include "port/linux/cpu/vector_path.hpp"

namespace flatpose::port {

VectorPath best_vector_path() noexcept {
#if defined(__aarch64__)
  return VectorPath::kNeon;  // no 64-bit Arm is without
#elif defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw"))
    return VectorPath::kAvx512;
  return __builtin_cpu_supports("avx2") ? VectorPath::kAvx2 : VectorPath::kPortable;
#else
  return VectorPath::kPortable;
#endif
}

}  // namespace flatpose::port
