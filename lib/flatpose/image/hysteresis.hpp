#pragma once
// Hysteresis on a map of marks: weak ones stay when a chain of neighbours leads to a strong one.

#include <cstdint>
#include <span>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// Marks in the high bits beside an EdgeKind in the low ones.
inline constexpr std::uint8_t kWeakMark = 0x40;
inline constexpr std::uint8_t kStrongMark = 0x80;
inline constexpr std::uint8_t kKindBits = 0x0F;

/// Takes the marks off: what is strong, or weak and 8-connected to a strong cell through weak ones
/// of its family (jumps of both kinds, or creases), keeps its kind; all else becomes 0.
/// Shape: sides up to 32767 cells; `stack` has room for every cell; the outermost ring carries no
/// marks. Cost: linear in cells.  Thread: reentrant.
void keep_connected(ImageView<std::uint8_t> marks, std::span<std::int32_t> stack,
                    VectorPath path = VectorPath::kPortable) noexcept;

}  // namespace flatpose::image
