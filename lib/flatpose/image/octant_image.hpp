#pragma once
// Eight bytes a cell, one for each direction in which an edge may fall. They lie side by side: one
// pass over the image works on all directions at once.

#include <array>
#include <cstdint>

#include "flatpose/core/image_view.hpp"
#include "flatpose/image/edge.hpp"

namespace flatpose::image {

struct alignas(kOctantCount) OctantCell {
  std::array<std::uint8_t, kOctantCount> of;
};

/// One of the eight directions, read like an image of its own.
struct OctantChannel {
  ImageView<const OctantCell> cells;
  int octant = 0;

  [[nodiscard]] std::uint8_t operator()(int x, int y) const noexcept {
    return cells(x, y).of[static_cast<std::size_t>(octant)];
  }
};

struct OctantImage {
  ImageView<OctantCell> cells;

  [[nodiscard]] OctantChannel operator[](int octant) const noexcept { return {cells, octant}; }
};

}  // namespace flatpose::image
