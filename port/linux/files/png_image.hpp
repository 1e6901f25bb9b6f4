#pragma once
// PNG files through libspng, within limits that are checked before anything is unpacked.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "port/linux/files/scan.hpp"

namespace flatpose::port {

struct PngImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> grey;  // 16-bit grey files
  std::vector<std::uint8_t> rgba;   // colour files, four bytes a pixel
};

enum class PngKind { kGrey16, kColour8 };

/// Whether the bytes start with PNG's signature.
[[nodiscard]] bool is_png(std::span<const std::byte> bytes) noexcept;

/// Unpacks a PNG of the kind asked for: 16-bit grey into `grey`, or RGB, RGBA or palette of up to 8
/// bits into `rgba`.
/// Fails: InputError when it is another kind, damaged, cut off or over the limits.
[[nodiscard]] PngImage read_png(const std::string& path, std::span<const std::byte> bytes,
                                PngKind kind, const ReadLimits& limits);

}  // namespace flatpose::port
