// Nodes against the least, or the greatest, of what their places read.

#include "flatpose/search/node_images.hpp"

#include <gtest/gtest.h>

#include "tests/lib/search/made_images.hpp"

namespace flatpose::search {
namespace {

std::int32_t node_at(const SearchImages& images, int index, int column, int row, int dx, int dy) {
  const Lattice& lattice = images.nodes.lattice;
  return *(images.nodes.bytes.data() + static_cast<std::size_t>(index) * lattice.image_bytes() +
           lattice.byte_of(column, row) + lattice.offset_bytes(dx, dy));
}

/// Over the places of a node's window that read inside the lattice's reach; beyond it all is alike.
std::int32_t slow_node(const SearchImages& images, int index, bool is_height, int column, int row,
                       int dx, int dy) {
  const int s = images.lattice.stride_px;
  const int side = images.nodes.side;
  const int reach_px = images.lattice.reach_px();
  const std::int32_t outside = is_height ? kOutsideUnit : kEdgeCostUnknown;
  std::int32_t found = -1;
  for (int b = 0; b < side + images.nodes.slack; ++b) {
    for (int a = 0; a < side + images.nodes.slack; ++a) {
      const int x = (column * side + a) * s + dx;
      const int y = (row * side + b) * s + dy;
      const bool is_inside =
          x >= -reach_px && y >= -reach_px && x < images.grid.width_px && y < images.grid.height_px;
      const std::int32_t value =
          is_inside ? images.at(is_height ? SearchImages::kSurfaceImage : index, x, y) : outside;
      if (found < 0 || (is_height ? value > found : value < found)) found = value;
    }
  }
  return found;
}

TEST(NodeImages, HoldTheLeastCostAndTheGreatestHeightOfAllPlacesOfAWindow) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 48; ++trial) {
    SearchImagesConfig config{1 + trial % kStrideMax_px, integer(random, 1, 9)};
    config.node_side = trial / 4 % 2 == 0 ? 2 : 4;
    config.node_slack = config.stride_px == 1 ? trial % 3 : 0;
    MadeImages made(integer(random, 1, 40), integer(random, 1, 20), config);
    if (trial == 0) continue;
    made.randomise(random);
    const SearchImages& images = made.images;
    const int reach_px = images.lattice.reach_px();
    const int span = images.lattice.stride_px * config.node_side;
    for (int probe = 0; probe < 400; ++probe) {
      const int column = integer(random, 0, (images.grid.width_px - 1) / span);
      const int row = integer(random, 0, (images.grid.height_px - 1) / span);
      const int dx = integer(random, -reach_px, reach_px);
      const int dy = integer(random, -reach_px, reach_px);
      const int octant = integer(random, 0, image::kOctantCount - 1);
      ASSERT_EQ(node_at(images, octant, column, row, dx, dy),
                slow_node(images, octant, false, column, row, dx, dy));
      ASSERT_EQ(node_at(images, NodeImages::kHeightImage, column, row, dx, dy),
                slow_node(images, 0, true, column, row, dx, dy));
    }
  }
}

}  // namespace
}  // namespace flatpose::search
