#pragma once
// Gaps into which the sensor cannot see: between parts that touch, or a hole that lies wholly in
// shadow. All around them the surface has about the same height, so a fill with the lower side
// closes them and their contours are lost. Nothing that was seen there means that it is lower.

#include <cstdint>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::image {

/// What `missing` holds in a dark pit.
inline constexpr std::uint8_t kDarkPit = 2;

struct DarkPitConfig {
  float level_mm = 1.0F;  ///< Sides this much apart are about the same height; > 0.
  float drop_mm = 4.0F;   ///< How far below its sides a pit is put; > level_mm.
};

/// Takes (and leaves taken) the scratch of lower_dark_pits, also from a measuring arena.
void reserve_dark_pit_scratch(Arena& arena, int width_px, int height_px) noexcept;

/// Lowers, and marks as kDarkPit, the missing cells whose four sides (left, right, above, below)
/// are about level, where the gap is too wide in both axes for points that were lost one by one:
/// how likely these are is read off the image's own single missing cells. Shape: `missing` and
/// `filled_mm` alike, as fill_missing writes them.  Cost: three passes over `missing`.  Memory:
/// `scratch`, given back.  Fails: kShapeMismatch, kInvalidArgument (config), kOutOfMemory.  Thread:
/// reentrant.
[[nodiscard]] Status lower_dark_pits(const DarkPitConfig& config, Arena& scratch,
                                     ImageView<std::uint8_t> missing, ImageView<float> filled_mm,
                                     VectorPath path = VectorPath::kPortable,
                                     const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::image
