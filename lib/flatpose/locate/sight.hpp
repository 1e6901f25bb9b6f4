#pragma once
// What a scan shows at a place, against what is expected there.

#include "flatpose/refine/fine_images.hpp"

namespace flatpose::locate {

/// Where what was seen stands against the expected height; kNothing: the scan does not tell.
enum class Sight { kNothing, kAbove, kAt, kBelow };

struct Cell {
  int column = 0;
  int row = 0;
};

/// The cell that a place lies in; it may lie outside the map.
[[nodiscard]] Cell cell_at(const rectify::Grid& grid, double x_mm, double y_mm) noexcept;

/// What stands at a place, read off the 3x3 cells around it.
struct Look {
  /// By the middle one of the heights, which noise leaves near the truth.
  Sight middle = Sight::kNothing;
  /// By the one that comes nearest to the expected height: a lost point or a cell's width at a
  /// contour decides nothing.
  Sight nearest = Sight::kNothing;
};

/// Looks at the cells around a place in work coordinates. Where nothing was seen, a dark place may
/// still be known to be lower.
[[nodiscard]] Look look(const refine::FineImages& images, const Vec3& p_mm,
                        double middle_tolerance_mm, double nearest_tolerance_mm) noexcept;

}  // namespace flatpose::locate
