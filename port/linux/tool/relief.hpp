#pragma once
// A height map as a picture: tinted by height and lit from the upper left, missing cells dark.

#include <array>
#include <cstdint>
#include <vector>

#include "flatpose/geometry/frames.hpp"
#include "flatpose/rectify/height_map.hpp"
#include "port/linux/tool/loaded_scan.hpp"

namespace flatpose::tool {

struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
};

/// The colour of a height, 0 the lowest and 1 the highest shown.
[[nodiscard]] Colour tint(double share) noexcept;

inline constexpr Colour kMissing{0.075, 0.085, 0.10};

struct Relief {
  rectify::Grid grid;   ///< Of the work frame; its row 0 is the picture's lowest.
  double low_mm = 0.0;  ///< Heights that the tint spans.
  double high_mm = 0.0;
  std::vector<std::uint32_t> xrgb;  ///< Rows from above: y of the work frame falls.
};

/// Rectifies the scan for a picture of at most `side_px` along the longer side; an empty one when
/// the scan shows nothing.
[[nodiscard]] Relief make_relief(const LoadedScan& loaded, int side_px);

}  // namespace flatpose::tool
