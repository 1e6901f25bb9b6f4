#pragma once
// The memory that scans are handed over in: while one is searched the next is loaded.

#include <cstddef>

#include "flatpose/locate/locator.hpp"

namespace flatpose::daemon {

inline constexpr int kScanBufferCount = 2;

/// Of x, y and z of the largest scan.
[[nodiscard]] inline std::size_t scan_buffer_bytes(const locate::Limits& limits) noexcept {
  return 3 * sizeof(float) * static_cast<std::size_t>(limits.scan_width_px) *
         static_cast<std::size_t>(limits.scan_height_px);
}

}  // namespace flatpose::daemon
