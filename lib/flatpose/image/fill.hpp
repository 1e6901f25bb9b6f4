#pragma once
// Fills what the sensor did not see. A missing cell takes the LOWEST of the nearest valid heights
// in the four axis directions: a shadow lies beside the thing that casts it and on the lower
// surface, so it becomes part of the lower surface. Its far border then makes no edge, and the
// upper contour stays where it is.

#include <cstdint>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// Takes (and leaves taken) the scratch of fill_missing, also from a measuring arena.
void reserve_fill_scratch(Arena& arena, int width_px) noexcept;

/// Writes a map without missing cells, and 1 in `missing` where a cell was filled, else 0. A cell
/// with nothing valid in any of the four directions takes the lowest height of the whole map.
/// Shape: all alike; `filled_mm` may be `height_mm` itself.  Units: mm.
/// Cost: two passes, linear in cells.  Memory: two rows of `scratch`, given back.
/// Fails: kShapeMismatch, kOutOfMemory; kTooFewPoints when nothing is valid: all cells are then 0
/// and missing.  Thread: reentrant; columns are shared out over `budget`.
Status fill_missing(ImageView<const float> height_mm, ImageView<float> filled_mm,
                    ImageView<std::uint8_t> missing, Arena& scratch,
                    VectorPath path = VectorPath::kPortable,
                    const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::image
