#pragma once
// Hysteresis on a map of marks: weak ones stay when a chain of neighbours leads to a strong one.

#include <cstdint>
#include <span>

#include "flatpose/core/image_view.hpp"

namespace flatpose::image {

/// Marks in the high bits beside an EdgeKind in the low ones.
inline constexpr std::uint8_t kWeakMark = 0x40;
inline constexpr std::uint8_t kStrongMark = 0x80;
inline constexpr std::uint8_t kKindBits = 0x0F;

/// Takes the marks off the strong cell (x, y), and off the weak and strong ones of its family
/// (jumps of both kinds, or creases) that are 8-connected to it through such cells: they keep their
/// kind. What is weak when all strong cells are through has no strong one. Shape: sides up to 32767
/// cells; `stack` has room for every marked cell; the outermost ring carries no marks. Cost: linear
/// in marked cells.  Thread: reentrant.
void keep_connected(ImageView<std::uint8_t> marks, int x, int y,
                    std::span<std::int32_t> stack) noexcept;

}  // namespace flatpose::image
