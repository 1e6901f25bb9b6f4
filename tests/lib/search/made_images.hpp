#pragma once
// Search images made by hand: cells that a test may write to, spread into bytes of exactly the size
// that the lattice asks for, so that the address sanitizer sees every read beyond.

#include <array>
#include <cstdint>
#include <vector>

#include "flatpose/search/search_images.hpp"
#include "tests/lib/image/image.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {

/// Level ground of height unit 100 with upright normals and no edge anywhere.
struct MadeImages {
  using Cells = image::Image<std::uint8_t>;

  SearchImages images;
  std::vector<Cells> edge;  // by octant
  Cells height;
  Cells normal_x;
  Cells normal_y;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> nodes;

  MadeImages(int width_px, int height_px, const SearchImagesConfig& config)
      : edge(image::kOctantCount, Cells(width_px, height_px, kEdgeCostMax)),
        height(width_px, height_px, 100),
        normal_x(width_px, height_px, kNormalZero),
        normal_y(width_px, height_px, kNormalZero) {
    images.grid = {0.0, 0.0, 1.0, width_px, height_px};
    images.config = config;
    images.lattice = make_lattice(width_px, height_px, config.stride_px, config.reach_px);
    images.height_unit_mm = config.height_tolerance_mm / kSurfaceCostMax;
    images.base_mm = -100.0 * images.height_unit_mm;
    bytes.resize(SearchImages::kImageCountMax * images.lattice.image_bytes());
    images.bytes = bytes;
    const auto node_bytes = [&] {
      return NodeImages::kImageCount * make_lattice(width_px, height_px,
                                                    config.stride_px * config.node_side,
                                                    images.lattice.reach_px())
                                           .image_bytes();
    };
    if (config.node_side > 0) nodes.resize(node_bytes());
    images.nodes.bytes = nodes;
    spread_all();
  }
  MadeImages(const MadeImages&) = delete;
  MadeImages& operator=(const MadeImages&) = delete;

  [[nodiscard]] int width() const { return images.grid.width_px; }
  [[nodiscard]] int height_px() const { return images.grid.height_px; }

  /// Brings what was written to the cells into the bytes.
  void spread_all() {
    for (int octant = 0; octant < image::kOctantCount; ++octant)
      spread_one(edge[static_cast<std::size_t>(octant)], kEdgeCostUnknown, octant);
    if (!images.config.use_directions) {
      Cells lowest = edge[0];
      for (const Cells& other : edge) {
        for_each([&](int x, int y) { lowest(x, y) = std::min(lowest(x, y), other(x, y)); });
      }
      spread_one(lowest, kEdgeCostUnknown, 0);
    }
    spread_one(images.config.use_height ? height : normal_x, kOutsideUnit,
               SearchImages::kSurfaceImage);
    spread_one(normal_y, kOutsideUnit, SearchImages::kSurfaceImage + 1);
    build_node_images(images);
  }

  template <class Function>
  void for_each(const Function& at) const {
    for (int y = 0; y < images.grid.height_px; ++y) {
      for (int x = 0; x < images.grid.width_px; ++x) at(x, y);
    }
  }

  /// Any value in every image that the score reads; few of them when `levels` is small, so that
  /// costs often are equal.
  void randomise(std::mt19937& random, int levels = 256) {
    const auto any = [&](int most) {
      const int steps = std::min(levels - 1, most);
      return static_cast<std::uint8_t>(integer(random, 0, steps) * most / steps);
    };
    for_each([&](int x, int y) {
      for (Cells& channel : edge) channel(x, y) = any(kEdgeCostMax);
      height(x, y) = any(kHeightUnitMax);
      normal_x(x, y) = any(2 * kNormalZero);
      normal_y(x, y) = any(2 * kNormalZero);
    });
    spread_all();
  }

 private:
  void spread_one(const Cells& cells, std::uint8_t outside, int index) {
    spread(cells.view(), images.lattice, outside,
           bytes.data() + static_cast<std::size_t>(index) * images.lattice.image_bytes());
  }
};

}  // namespace flatpose::search
