#pragma once
// Four numbers side by side, by the vector types of GCC and Clang: the same bits on every machine,
// and quick whatever the optimiser makes of loops.

#include <cstdint>
#include <cstring>

namespace flatpose::rectify {

inline constexpr int kLanes = 4;

using Int4 = std::int32_t __attribute__((vector_size(16)));  ///< As a mask: all ones for true.
using Float4 = float __attribute__((vector_size(16)));

template <class Lanes, class T>
[[nodiscard]] inline Lanes load(const T* from) noexcept {
  static_assert(sizeof(Lanes) == kLanes * sizeof(T));
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
template <class Lanes, class T>
inline void store(T* to, const Lanes& lanes) noexcept {
  static_assert(sizeof(Lanes) == kLanes * sizeof(T));
  std::memcpy(to, &lanes, sizeof(lanes));
}
[[nodiscard]] inline Int4 load4(const std::int32_t* from) noexcept { return load<Int4>(from); }
[[nodiscard]] inline Float4 load4(const float* from) noexcept { return load<Float4>(from); }

[[nodiscard]] inline Float4 to_float(Int4 lanes) noexcept {
  return __builtin_convertvector(lanes, Float4);
}
[[nodiscard]] inline Int4 smaller(Int4 a, Int4 b) noexcept { return a < b ? a : b; }
[[nodiscard]] inline Int4 larger(Int4 a, Int4 b) noexcept { return a > b ? a : b; }
[[nodiscard]] inline Float4 smaller(Float4 a, Float4 b) noexcept { return a < b ? a : b; }
[[nodiscard]] inline Float4 larger(Float4 a, Float4 b) noexcept { return a > b ? a : b; }
[[nodiscard]] inline Float4 absolute(Float4 lanes) noexcept {
  return reinterpret_cast<Float4>(reinterpret_cast<Int4>(lanes) & 0x7fffffff);
}
[[nodiscard]] inline bool any(Int4 mask) noexcept {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}

[[nodiscard]] inline bool all(Int4 mask) noexcept {
  return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
}

}  // namespace flatpose::rectify
