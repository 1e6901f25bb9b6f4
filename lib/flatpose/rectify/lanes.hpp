#pragma once
// Numbers side by side, by the vector types of GCC and Clang: the same bits on every machine, and
// quick whatever the optimiser makes of loops. FLATPOSE_LANES says how many, 4 unless a source file
// defines it. All is local to its file: nothing compiled for a wide processor may be linked into
// what runs on another.

#include <cstdint>
#include <cstring>

#ifndef FLATPOSE_LANES
#define FLATPOSE_LANES 4
#endif

namespace flatpose::rectify {
namespace {

constexpr int kLanes = FLATPOSE_LANES;

using Ints = std::int32_t
    __attribute__((vector_size(4 * FLATPOSE_LANES)));  ///< As a mask: all ones for true.
using Floats = float __attribute__((vector_size(4 * FLATPOSE_LANES)));

template <class Lanes, class T>
inline Lanes load(const T* from) noexcept {
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
inline Ints load(const std::int32_t* from) noexcept { return load<Ints>(from); }
inline Floats load(const float* from) noexcept { return load<Floats>(from); }

inline Floats to_float(Ints lanes) noexcept { return __builtin_convertvector(lanes, Floats); }
inline Ints smaller(Ints a, Ints b) noexcept { return a < b ? a : b; }
inline Ints larger(Ints a, Ints b) noexcept { return a > b ? a : b; }
inline Floats smaller(Floats a, Floats b) noexcept { return a < b ? a : b; }
inline Floats larger(Floats a, Floats b) noexcept { return a > b ? a : b; }
inline Floats absolute(Floats lanes) noexcept {
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(lanes) & 0x7fffffff);
}
inline bool any(Ints mask) noexcept {
  std::uint64_t words[FLATPOSE_LANES / 2];
  std::memcpy(words, &mask, sizeof mask);
  std::uint64_t bits = 0;
  for (const std::uint64_t word : words) bits |= word;
  return bits != 0;
}
inline bool all(Ints mask) noexcept { return !any(~mask); }

}  // namespace
}  // namespace flatpose::rectify
