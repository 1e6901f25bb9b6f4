#pragma once
// Count and bounding box of the points of a scan, added up row by row.

#include <array>
#include <cstdint>
#include <limits>

namespace flatpose::rectify {

struct Extent {
  static constexpr float kFar_mm = std::numeric_limits<float>::infinity();

  std::array<float, 3> min_mm = {kFar_mm, kFar_mm, kFar_mm};
  std::array<float, 3> max_mm = {-kFar_mm, -kFar_mm, -kFar_mm};
  std::int32_t valid_count = 0;
  bool has_wild = false;  ///< A coordinate is infinite or giant.
};

/// Three rows of rotation and translation. The box needs no more than float.
using Affine = std::array<float, 12>;

}  // namespace flatpose::rectify
