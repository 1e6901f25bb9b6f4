#pragma once
// The memory that scans are handed over in: while one is searched the next is loaded.

#include <cstddef>
#include <cstring>
#include <span>

#include "flatpose/locate/locator.hpp"

namespace flatpose::daemon {

inline constexpr int kScanBufferCount = 2;

/// Of x, y and z of the largest scan.
[[nodiscard]] inline std::size_t scan_buffer_bytes(const locate::Limits& limits) noexcept {
  return 3 * sizeof(float) * static_cast<std::size_t>(limits.scan_width_px) *
         static_cast<std::size_t>(limits.scan_height_px);
}

/// Whether both are the same bits: NaN, which stands for a missing point, is like itself.
[[nodiscard]] inline bool are_same_bits(std::span<const float> one,
                                        std::span<const float> other) noexcept {
  return one.size() == other.size() && std::memcmp(one.data(), other.data(), one.size_bytes()) == 0;
}

}  // namespace flatpose::daemon
