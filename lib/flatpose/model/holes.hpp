#pragma once
// The holes of a part, read off its contour: closed loops at which the surface falls inward. What
// tells a part from its look-alike, or from itself lying on its face, is often a hole alone, and a
// hole is little beside the rest of the contour.

#include <array>
#include <cstdint>
#include <span>

#include "flatpose/model/template.hpp"

namespace flatpose::model {

inline constexpr int kHoleCountMax = 16;
inline constexpr std::uint8_t kNoHole = 255;

struct Holes {
  std::array<std::uint8_t, kContourPointCountMax> hole_of_point{};  ///< kNoHole: of the outline.
  std::array<int, kHoleCountMax> point_count{};
  int count = 0;
};

/// Finds the closed loops among the contour points.
/// Cost: contour points squared.  Memory: none.  Thread: reentrant.
[[nodiscard]] Holes find_holes(const Template& part) noexcept;

}  // namespace flatpose::model
