#pragma once
// Points that the sensor lost one by one, told from what it could not see: they are missing alone.

#include <cstdint>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// Share of the points that are lost by accident, each for itself: with a share p of them a cell is
/// missing and its four neighbours are not with probability s = p (1 - p)^4, and s is counted.
/// Shares over 0.2 are told as less.
/// Cost: one pass.  Memory: none.  Thread: reentrant.
[[nodiscard]] double lost_share(ImageView<const std::uint8_t> missing,
                                VectorPath path = VectorPath::kPortable) noexcept;

/// The least side of a square, at least `least_px`, such that squares lost by accident as a whole
/// are in no more than one of a hundred such images.
[[nodiscard]] int accidental_side_px(ImageView<const std::uint8_t> missing, int least_px,
                                     VectorPath path = VectorPath::kPortable) noexcept;

}  // namespace flatpose::image
