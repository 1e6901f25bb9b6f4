#pragma once
// Numbers side by side, by the vector types of GCC and Clang: the same bits on every machine, and
// quick whatever the optimiser makes of loops. FLATPOSE_LANES says how many, 4 unless a source file
// defines it. All is local to its file: nothing compiled for a wide processor may be linked into
// what runs on another.

#include <cstdint>
#include <cstring>
#include <utility>

#ifndef FLATPOSE_LANES
#define FLATPOSE_LANES 4
#endif
#if FLATPOSE_LANES > 4 || defined(__SSE2__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
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
inline Ints to_int(Floats lanes) noexcept { return __builtin_convertvector(lanes, Ints); }
inline Floats spread(float value) noexcept { return value - Floats{}; }
inline Floats square_root(Floats lanes) noexcept {
#if FLATPOSE_LANES == 16
  return reinterpret_cast<Floats>(_mm512_maskz_sqrt_ps(0xFFFF, reinterpret_cast<__m512>(lanes)));
#elif FLATPOSE_LANES == 8
  return reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(lanes)));
#else
  for (int k = 0; k < kLanes; ++k) lanes[k] = __builtin_sqrtf(lanes[k]);
  return lanes;
#endif
}
template <int... K>
inline Ints counted(std::integer_sequence<int, K...>) noexcept {
  return Ints{K...};
}
/// 0, 1, 2 ...
inline Ints counted() noexcept { return counted(std::make_integer_sequence<int, kLanes>{}); }
/// base[index] for each lane.
inline Floats gather(const float* base, Ints index) noexcept {
#if FLATPOSE_LANES == 16
  return reinterpret_cast<Floats>(_mm512_mask_i32gather_ps(
      __m512{}, 0xFFFF, reinterpret_cast<__m512i>(index), base, sizeof(float)));
#elif FLATPOSE_LANES == 8
  return reinterpret_cast<Floats>(
      _mm256_i32gather_ps(base, reinterpret_cast<__m256i>(index), sizeof(float)));
#else
  return Floats{base[index[0]], base[index[1]], base[index[2]], base[index[3]]};
#endif
}
inline Ints gather(const std::int32_t* base, Ints index) noexcept {
#if FLATPOSE_LANES == 16
  return reinterpret_cast<Ints>(_mm512_mask_i32gather_epi32(
      __m512i{}, 0xFFFF, reinterpret_cast<__m512i>(index), base, sizeof(std::int32_t)));
#elif FLATPOSE_LANES == 8
  return reinterpret_cast<Ints>(
      _mm256_i32gather_epi32(base, reinterpret_cast<__m256i>(index), sizeof(std::int32_t)));
#else
  return Ints{base[index[0]], base[index[1]], base[index[2]], base[index[3]]};
#endif
}
struct Pairs {
  Floats first, second;
};
template <int... K>
inline Pairs every_second(const Floats& low, const Floats& high,
                          std::integer_sequence<int, K...>) noexcept {
  return {__builtin_shufflevector(low, high, 2 * K...),
          __builtin_shufflevector(low, high, 2 * K + 1 ...)};
}
/// base[kStep * index] and the number after it for each lane.
template <int kStep>
inline Pairs gather_pairs(const float* base, Ints index) noexcept {
  static_assert(kStep == 1 || kStep == 2);
#if FLATPOSE_LANES == 16
  using Eight = std::int32_t __attribute__((vector_size(32)));
  const auto half = [base](Eight at) {
    return reinterpret_cast<Floats>(
        _mm512_mask_i32gather_pd(__m512d{}, 0xFF, reinterpret_cast<__m256i>(at), base,
                                 kStep * static_cast<int>(sizeof(float))));
  };
  return every_second(half(__builtin_shufflevector(index, index, 0, 1, 2, 3, 4, 5, 6, 7)),
                      half(__builtin_shufflevector(index, index, 8, 9, 10, 11, 12, 13, 14, 15)),
                      std::make_integer_sequence<int, kLanes>{});
#elif FLATPOSE_LANES == 8
  const __m256i at = reinterpret_cast<__m256i>(index);
  const __m256d every = reinterpret_cast<__m256d>(Ints{} - 1);
  const auto half = [base, every](__m128i four) {
    return reinterpret_cast<Floats>(
        _mm256_mask_i32gather_pd(__m256d{}, reinterpret_cast<const double*>(base), four, every,
                                 kStep * static_cast<int>(sizeof(float))));
  };
  return every_second(half(_mm256_castsi256_si128(at)), half(_mm256_extracti128_si256(at, 1)),
                      std::make_integer_sequence<int, kLanes>{});
#else
  using Two = float __attribute__((vector_size(8)));
  const auto two = [base, at = kStep * index](int k) {
    Two pair;
    std::memcpy(&pair, base + at[k], sizeof pair);
    return pair;
  };
  return every_second(__builtin_shufflevector(two(0), two(1), 0, 1, 2, 3),
                      __builtin_shufflevector(two(2), two(3), 0, 1, 2, 3),
                      std::make_integer_sequence<int, kLanes>{});
#endif
}
/// The bytes base[index] of an image of `size` bytes, at least 4.
inline Ints gather_bytes(const std::uint8_t* base, [[maybe_unused]] std::int32_t size,
                         Ints index) noexcept {
#if FLATPOSE_LANES > 4
  // Four bytes at once, none of them beyond the end.
  const Ints first = smaller(index, size - 4 - Ints{});
#if FLATPOSE_LANES == 16
  const Ints four = reinterpret_cast<Ints>(
      _mm512_mask_i32gather_epi32(__m512i{}, 0xFFFF, reinterpret_cast<__m512i>(first), base, 1));
#else
  const Ints four = reinterpret_cast<Ints>(_mm256_i32gather_epi32(
      reinterpret_cast<const int*>(base), reinterpret_cast<__m256i>(first), 1));
#endif
  return four >> (8 * (index - first)) & 0xFF;
#else
  return Ints{base[index[0]], base[index[1]], base[index[2]], base[index[3]]};
#endif
}
/// A mask with a bit for each lane.
inline unsigned bits(Ints mask) noexcept {
#if FLATPOSE_LANES == 16
  return _mm512_test_epi32_mask(reinterpret_cast<__m512i>(mask), reinterpret_cast<__m512i>(mask));
#elif FLATPOSE_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#elif defined(__aarch64__)
  constexpr Ints kBits = {1, 2, 4, 8};
  return vaddvq_u32(reinterpret_cast<uint32x4_t>(mask & kBits));
#else
  return (mask[0] & 1U) | (mask[1] & 2U) | (mask[2] & 4U) | (mask[3] & 8U);
#endif
}
/// Writes the lanes of a mask one close to the other, and whatever up to a vector's length.
template <class Lanes, class T>
inline void pack([[maybe_unused]] unsigned set, const Lanes& lanes, T* to) noexcept {
#if FLATPOSE_LANES == 16
  const __m512i together =
      _mm512_maskz_compress_epi32(static_cast<__mmask16>(set), reinterpret_cast<__m512i>(lanes));
  std::memcpy(to, &together, sizeof together);
#else
  int count = 0;
  for (int k = 0; k < kLanes; ++k) {
    to[count] = lanes[k];
    count += static_cast<int>(set >> k & 1U);
  }
#endif
}
/// Calls body(lane) for each bit, from the lowest on.
template <class Body>
inline void for_each_bit(unsigned set, const Body& body) noexcept {
  for (; set != 0; set &= set - 1) body(__builtin_ctz(set));
}
inline bool any(Ints mask) noexcept { return bits(mask) != 0; }
inline bool all(Ints mask) noexcept { return !any(~mask); }

}  // namespace
}  // namespace flatpose::rectify
