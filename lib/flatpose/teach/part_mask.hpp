#pragma once
// Which cells of a teach scan are the part's surface.
//
// Contours are barriers that divide the scan into areas. With a region, the areas that lie mostly
// in it are the part, whole, and all others background; without one, what cannot be reached from
// the border of the scan. Pits do not count: holes through which something lower shows, which lie
// lower than all around them.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/geometry/region.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::teach {

/// The thesis's labelled picture: what each pixel of the scan is (Ingberg 2015, figure 2.1).
enum class Label : std::uint8_t { kNone = 0, kEdge = 1, kSurface = 2, kOrigin = 3 };

struct PartMask {
  ImageView<std::uint8_t> is_part;     ///< 1: the part's surface.
  ImageView<std::uint8_t> is_contour;  ///< 1: an edge cell whose upper side is the part.
  std::int32_t cell_count = 0;
  bool lies_below = false;  ///< Most of its border falls toward it.
};

[[nodiscard]] PartMask take_part_mask(Arena& arena, const rectify::Grid& grid) noexcept;
/// Takes (and leaves taken) the scratch of the functions below, also from a measuring arena.
void reserve_mask_scratch(Arena& arena, const rectify::Grid& grid) noexcept;

/// Finds the part inside a region of the face's frame; Region::Kind::kAll takes the lone part that
/// stands in the scan. A region drawn inside of a larger surface, where nothing is shut in, is
/// itself the part. Fails: kNoPart, kSeveralParts (without a region, when two of like size stand
/// apart), kOutOfMemory.
[[nodiscard]] Status find_part(const scene::Scene& scene, const Frames& frames,
                               const Region& region, Arena& scratch, PartMask& mask) noexcept;

/// Takes surface and contour from a labelled picture of the scan's size.
/// Shape: `labels` as the scan, a Label each.  Fails: kNoPart (no surface labelled), kNoContour.
[[nodiscard]] Status mask_from_labels(const scene::Scene& scene,
                                      ImageView<const std::uint8_t> labels,
                                      PartMask& mask) noexcept;

}  // namespace flatpose::teach
