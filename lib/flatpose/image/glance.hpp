#pragma once
// Finds the few bytes of a row that are not zero, eight at a glance.

#include <cstdint>
#include <cstring>

namespace flatpose::image {

/// The first nonzero byte from `x` on, or width_px.
[[nodiscard]] inline int next_set(const std::uint8_t* row, int x, int width_px) noexcept {
  constexpr int kGlance = 8;
  for (; x + kGlance <= width_px; x += kGlance) {
    std::uint64_t glance;
    std::memcpy(&glance, row + x, kGlance);
    if (glance != 0) break;
  }
  while (x < width_px && row[x] == 0) ++x;
  return x;
}

/// Calls body(x) for each nonzero byte of a row; it may change that byte.
template <class Body>
void for_each_set(const std::uint8_t* row, int width_px, const Body& body) noexcept {
  for (int x = next_set(row, 0, width_px); x < width_px; x = next_set(row, x + 1, width_px))
    body(x);
}

/// Calls body(begin, end) for each run of nonzero bytes.
template <class Body>
void for_each_run(const std::uint8_t* row, int width_px, const Body& body) noexcept {
  int begin = next_set(row, 0, width_px);
  while (begin < width_px) {
    int end = begin + 1;
    while (end < width_px && row[end] != 0) ++end;
    body(begin, end);
    begin = next_set(row, end, width_px);
  }
}

}  // namespace flatpose::image
