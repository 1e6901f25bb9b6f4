#pragma once
// The 3-4 chamfer distance transform (Borgefors 1986; Ingberg 2015, eq. 2.2): the length of the
// cheapest 8-connected path to a set cell, 3 a straight and 4 a diagonal step. In thirds of a cell
// it is within 8 % of the Euclidean distance.

#include <cstdint>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// Writes the distance to the nearest nonzero cell of `mask`, at most 65535 (also when there is
/// none).
/// Shape: both alike; no overlap.  Units: thirds of a cell.  Cost: two passes, linear in cells.
/// Memory: none.  Fails: kShapeMismatch.  Thread: reentrant.
Status chamfer_distance(ImageView<const std::uint8_t> mask,
                        ImageView<std::uint16_t> distance_third_px) noexcept;

/// The same, at most 255 (85 cells).
Status chamfer_distance(ImageView<const std::uint8_t> mask,
                        ImageView<std::uint8_t> distance_third_px,
                        VectorPath path = VectorPath::kPortable) noexcept;

}  // namespace flatpose::image
