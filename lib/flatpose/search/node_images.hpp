#pragma once
// Images for branch and bound: a node stands for node_side x node_side neighbouring places, and its
// byte is the least (edges) or the greatest (heights) that any of its places would read. The node
// that holds a place thus never costs more than the place does: see bound in block_search.hpp.
//
// For offset u of a template point, and a window of W x W places,
//   (1)  node(X, Y; u) = min over 0 <= a, b < W of place(k X + a, k Y + b; u),   k = node_side
// Places of one tilt share their offsets to the bit, so no rounding enters. W is k, or k + slack
// where one node also stands for angles whose offsets differ by up to `slack` places.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/image/octant_image.hpp"
#include "flatpose/search/lattice.hpp"

namespace flatpose::search {

struct SearchImages;

inline constexpr int kNodeSideMax = 4;   ///< A power of two, as all sides.
inline constexpr int kNodeSlackMax = 2;  ///< Places.

struct NodeImages {
  static constexpr int kHeightImage = image::kOctantCount;
  static constexpr int kImageCount = image::kOctantCount + 1;

  int side = 0;  ///< Places across a node; 0: there are no nodes.
  int slack = 0;
  Lattice lattice;  ///< A node where the images have a place.
  std::span<std::uint8_t> bytes;
};

/// Takes memory for the nodes of images of this size, whatever their stride and side.
[[nodiscard]] NodeImages take_node_images(Arena& arena, int width_px, int height_px) noexcept;

/// Fills `images.nodes` from the images, as their config says.
/// Cost: one pass over the images.  Memory: none.
void build_node_images(SearchImages& images) noexcept;

}  // namespace flatpose::search
