#include "flatpose/locate/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flatpose/image/dark_pit.hpp"

namespace flatpose::locate {
namespace {

// Where nothing was seen. What casts a shadow is higher than what lies in it, so where nothing
// beside the dark is higher than the part, and something is lower or all is level around a gap too
// wide to be lost points, there is a hole.
Sight sight_in_the_dark(const refine::FineImages& images, const Cell& cell, const Vec3& p_mm,
                        double tolerance_mm) noexcept {
  constexpr int kReach_px = 40;
  if (!images.missing.contains(cell.column, cell.row)) return Sight::kNothing;
  bool is_open = images.missing(cell.column, cell.row) == image::kDarkPit;
  constexpr std::array<Cell, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (const Cell& side : kSides) {
    Cell at = cell;
    int steps = 0;
    while (images.missing.contains(at.column, at.row) && images.missing(at.column, at.row) != 0 &&
           ++steps < kReach_px) {
      at = {at.column + side.column, at.row + side.row};
    }
    if (!images.missing.contains(at.column, at.row) || steps == kReach_px) return Sight::kNothing;
    const double above_mm = static_cast<double>(images.height_mm(at.column, at.row)) - p_mm.z;
    if (above_mm > tolerance_mm) return Sight::kNothing;
    is_open |= above_mm < -tolerance_mm;
  }
  return is_open ? Sight::kBelow : Sight::kNothing;
}

Sight sight_of(double above_mm, double tolerance_mm) noexcept {
  if (above_mm > tolerance_mm) return Sight::kAbove;
  return above_mm < -tolerance_mm ? Sight::kBelow : Sight::kAt;
}

}  // namespace

Cell cell_at(const rectify::Grid& grid, double x_mm, double y_mm) noexcept {
  return {static_cast<int>(std::floor(grid.column_of(x_mm) + 0.5)),
          static_cast<int>(std::floor(grid.row_of(y_mm) + 0.5))};
}

Look look(const refine::FineImages& images, const Vec3& p_mm, double middle_tolerance_mm,
          double nearest_tolerance_mm) noexcept {
  const Cell centre = cell_at(images.grid, p_mm.x, p_mm.y);
  const ImageView<const float>& height_mm = images.height_mm;
  const int x0 = std::max(centre.column - 1, 0);
  const int x1 = std::min(centre.column + 1, height_mm.width_px - 1);
  const int y0 = std::max(centre.row - 1, 0);
  const int y1 = std::min(centre.row + 1, height_mm.height_px - 1);
  double nearest_mm = std::numeric_limits<double>::infinity();
  int count = 0;
  int above_count = 0;
  int below_count = 0;
  for (int y = y0; y <= y1; ++y) {
    const float* row = height_mm.row(y);
    for (int x = x0; x <= x1; ++x) {
      const double above_mm = static_cast<double>(row[x]) - p_mm.z;
      if (std::isnan(above_mm)) continue;
      ++count;
      above_count += above_mm > middle_tolerance_mm ? 1 : 0;
      below_count += above_mm < -middle_tolerance_mm ? 1 : 0;
      if (std::fabs(above_mm) < std::fabs(nearest_mm)) nearest_mm = above_mm;
    }
  }
  if (count == 0) {
    return {sight_in_the_dark(images, centre, p_mm, middle_tolerance_mm),
            sight_in_the_dark(images, centre, p_mm, nearest_tolerance_mm)};
  }
  // In ascending order the middle one has the index count / 2.
  Look out{Sight::kAt, sight_of(nearest_mm, nearest_tolerance_mm)};
  if (above_count >= count - count / 2) out.middle = Sight::kAbove;
  if (below_count > count / 2) out.middle = Sight::kBelow;
  return out;
}

}  // namespace flatpose::locate
