#pragma once
// Finds the few bytes of a row that are not zero, eight and more at a glance.

#include <bit>
#include <cstdint>
#include <cstring>

namespace flatpose::image {

/// Eight bytes from `row` on, of which the first is the lowest.
[[nodiscard]] inline std::uint64_t eight_from(const std::uint8_t* row) noexcept {
  std::uint64_t eight = 0;
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(&eight, row, sizeof eight);
  } else {
    for (int i = 7; i >= 0; --i) eight = eight << 8U | row[i];
  }
  return eight;
}

/// What eight_from() reads.
inline void write_eight(std::uint64_t eight, std::uint8_t* row) noexcept {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(row, &eight, sizeof eight);
  } else {
    for (int i = 0; i < 8; ++i) row[i] = static_cast<std::uint8_t>(eight >> (8 * i));
  }
}

/// The first nonzero byte from `x` on, or width_px.
[[nodiscard]] inline int next_set(const std::uint8_t* row, int x, int width_px) noexcept {
  constexpr int kGlance = 8;
  for (; x + kGlance <= width_px; x += kGlance) {
    const std::uint64_t glance = eight_from(row + x);
    if (glance != 0) return x + std::countr_zero(glance) / 8;
  }
  while (x < width_px && row[x] == 0) ++x;
  return x;
}

/// The first zero byte from `x` on, or width_px.
[[nodiscard]] inline int next_clear(const std::uint8_t* row, int x, int width_px) noexcept {
  constexpr int kGlance = 8;
  constexpr std::uint64_t kOnes = 0x0101010101010101U;
  for (; x + kGlance <= width_px; x += kGlance) {
    const std::uint64_t glance = eight_from(row + x);
    // The highest bit of each zero byte; above the lowest such byte others may have it too.
    const std::uint64_t clear = (glance - kOnes) & ~glance & (kOnes << 7U);
    if (clear != 0) return x + std::countr_zero(clear) / 8;
  }
  while (x < width_px && row[x] != 0) ++x;
  return x;
}

/// Past as many zero bytes as four glances see.
[[nodiscard]] inline int past_clear(const std::uint8_t* row, int x, int width_px) noexcept {
  constexpr int kLongGlance = 32;
  while (x + kLongGlance <= width_px) {
    const std::uint64_t both = eight_from(row + x) | eight_from(row + x + 8);
    if ((both | eight_from(row + x + 16) | eight_from(row + x + 24)) != 0) break;
    x += kLongGlance;
  }
  return x;
}

/// Calls body(x) for each byte of a row that is not zero when it is looked at; the next ones are
/// looked at with it. The body may change any.
template <class Body>
void for_each_set(const std::uint8_t* row, int width_px, const Body& body) noexcept {
  constexpr int kGlance = 8;
  int x = past_clear(row, 0, width_px);
  for (; x + kGlance <= width_px; x += kGlance) {
    std::uint64_t glance = eight_from(row + x);
    if (glance == 0) {
      x = past_clear(row, x + kGlance, width_px) - kGlance;
      continue;
    }
    while (glance != 0) {
      const int byte = std::countr_zero(glance) / 8;
      glance &= ~(std::uint64_t{0xFF} << (8 * byte));
      body(x + byte);
    }
  }
  for (; x < width_px; ++x) {
    if (row[x] != 0) body(x);
  }
}

/// As for_each_set(), from the end of the row to its beginning.
template <class Body>
void for_each_set_backward(const std::uint8_t* row, int width_px, const Body& body) noexcept {
  constexpr int kGlance = 8;
  int end = width_px;
  for (; end % kGlance != 0; --end) {
    if (row[end - 1] != 0) body(end - 1);
  }
  for (; end > 0; end -= kGlance) {
    std::uint64_t glance = eight_from(row + end - kGlance);
    while (glance != 0) {
      const int byte = 7 - std::countl_zero(glance) / 8;
      glance &= ~(std::uint64_t{0xFF} << (8 * byte));
      body(end - kGlance + byte);
    }
  }
}

/// Calls body(begin, end) for each run of nonzero bytes.
template <class Body>
void for_each_run(const std::uint8_t* row, int width_px, const Body& body) noexcept {
  int begin = next_set(row, 0, width_px);
  while (begin < width_px) {
    const int end = next_clear(row, begin + 1, width_px);
    body(begin, end);
    begin = next_set(row, end, width_px);
  }
}

}  // namespace flatpose::image
