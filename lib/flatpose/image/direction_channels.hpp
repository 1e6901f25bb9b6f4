#pragma once
// Edges sorted by the direction in which the height falls: eight binary images, and the distance to
// the nearest edge of each. A contour point of a template is then held against edges that fall to
// the same side only.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/maths.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/image/edge.hpp"

namespace flatpose::image {

struct ChannelConfig {
  /// An edge goes into every octant whose centre is within this angle of its direction; in rad,
  /// from pi/8 (each edge in one octant) to pi (each in all). More forgives more wrong directions.
  double half_width_rad = 37.5 * kRadPerDeg;
  bool with_creases = false;  ///< Whether creases, whose direction means less, are drawn too.
};

using OctantImages = std::array<ImageView<std::uint8_t>, kOctantCount>;

/// Draws each edge as 1 at its (column, row) in the images of its octants; all other cells 0.
/// Shape: eight images alike; edges outside are left out.  Cost: linear in cells plus edges.
/// Memory: none.  Fails: kShapeMismatch, kInvalidArgument (angle).  Thread: reentrant.
Status draw_direction_channels(std::span<const EdgePoint> edges, const ChannelConfig& config,
                               const OctantImages& masks) noexcept;

/// The 3-4 chamfer distance of each of the eight masks, at most 255 thirds of a cell.
/// Fails: kShapeMismatch.  Thread: reentrant.
Status chamfer_channels(const OctantImages& masks, const OctantImages& distance_third_px) noexcept;

}  // namespace flatpose::image
