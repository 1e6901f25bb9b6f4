#pragma once
// Edges sorted by the direction in which the height falls, and the distance to the nearest edge of
// each of eight directions. A contour point of a template is then held against edges that fall to
// the same side only.
//
// The distance is the 3-4 chamfer distance of chamfer.hpp. Its two passes run along the rows, where
// each cell waits for the one before; eight directions side by side wait together, and cells as
// many as a vector holds in steps of one, two and four.

#include <cstdint>
#include <span>

#include "flatpose/core/budget.hpp"
#include "flatpose/core/maths.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/image/edge.hpp"
#include "flatpose/image/octant_image.hpp"

namespace flatpose::image {

/// Distances saturate here at the latest (80 cells): a step more still fits a byte.
inline constexpr std::uint8_t kOctantDistanceMax_third_px = 240;

struct ChannelConfig {
  /// An edge goes into every octant whose centre is within this angle of its direction; in rad,
  /// from pi/8 (each edge in one octant) to pi (each in all). More forgives more wrong directions.
  double half_width_rad = 37.5 * kRadPerDeg;
  bool with_creases = false;  ///< Whether creases, whose direction means less, take part too.
  int edge_cells = 1;         ///< Cells of the edges' map to a side of one of the image's; >= 1.
  /// What all beyond reads, in thirds of the image's cell; 1..kOctantDistanceMax_third_px.
  std::uint8_t distance_max_third_px = kOctantDistanceMax_third_px;
};

/// Writes the chamfer distance of every cell to the nearest edge of each octant. Edges outside are
/// left out.
/// Shape: edges by rows, as detect_edges leaves them.  Units: thirds of a cell.
/// Cost: two passes, linear in cells plus edges.  Memory: none.
/// Fails: kInvalidArgument (config, order of the edges).  Thread: reentrant.
Status edge_distances(std::span<const EdgePoint> edges, const ChannelConfig& config,
                      const OctantImage& distance_third_px, VectorPath path = VectorPath::kPortable,
                      const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::image
