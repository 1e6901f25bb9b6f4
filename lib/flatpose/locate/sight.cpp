#include "flatpose/locate/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/dark_pit.hpp"

namespace flatpose::locate {
namespace {

// What stands around a place where nothing was seen, along the four directions of the map.
struct DarkSides {
  bool are_seen = false;  // all four within reach
  bool is_pit = false;
  double highest_mm = -std::numeric_limits<double>::infinity();  // above the place
  double lowest_mm = std::numeric_limits<double>::infinity();
};

DarkSides dark_sides(const refine::FineImages& images, const Cell& cell, double z_mm) noexcept {
  constexpr int kReach_px = 40;
  DarkSides out;
  if (!images.missing.contains(cell.column, cell.row)) return out;
  out.is_pit = images.missing(cell.column, cell.row) == image::kDarkPit;
  constexpr std::array<Cell, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (const Cell& side : kSides) {
    Cell at = cell;
    int steps = 0;
    while (images.missing.contains(at.column, at.row) && images.missing(at.column, at.row) != 0 &&
           ++steps < kReach_px) {
      at = {at.column + side.column, at.row + side.row};
    }
    if (!images.missing.contains(at.column, at.row) || steps == kReach_px) return out;
    const double above_mm = static_cast<double>(images.height_mm(at.column, at.row)) - z_mm;
    out.highest_mm = std::max(out.highest_mm, above_mm);
    out.lowest_mm = std::min(out.lowest_mm, above_mm);
  }
  out.are_seen = true;
  return out;
}

// What casts a shadow is higher than what lies in it, so where nothing beside the dark is higher
// than the part, and something is lower or all is level around a gap too wide to be lost points,
// there is a hole.
Sight sight_in_the_dark(const DarkSides& sides, double tolerance_mm) noexcept {
  if (!sides.are_seen || sides.highest_mm > tolerance_mm) return Sight::kNothing;
  return sides.is_pit || sides.lowest_mm < -tolerance_mm ? Sight::kBelow : Sight::kNothing;
}

Sight sight_of(double above_mm, double tolerance_mm) noexcept {
  if (above_mm > tolerance_mm) return Sight::kAbove;
  return above_mm < -tolerance_mm ? Sight::kBelow : Sight::kAt;
}

// What the heights around a place tell.
struct Heights {
  int count = 0;
  int above_count = 0;
  int below_count = 0;
  double nearest_mm = std::numeric_limits<double>::infinity();

  void add(double above_mm, double tolerance_mm) noexcept {
    if (std::isnan(above_mm)) return;
    ++count;
    above_count += above_mm > tolerance_mm ? 1 : 0;
    below_count += above_mm < -tolerance_mm ? 1 : 0;
    if (std::fabs(above_mm) < std::fabs(nearest_mm)) nearest_mm = above_mm;
  }
};

Heights heights_at_the_rim(ImageView<const float> height_mm, const Cell& centre, double z_mm,
                           double tolerance_mm) noexcept {
  Heights out;
  for (int y = std::max(centre.row - 1, 0); y <= std::min(centre.row + 1, height_mm.height_px - 1);
       ++y) {
    const int end = std::min(centre.column + 2, height_mm.width_px);
    for (int x = std::max(centre.column - 1, 0); x < end; ++x)
      out.add(static_cast<double>(height_mm(x, y)) - z_mm, tolerance_mm);
  }
  return out;
}

// The same where a row of four cells can be read: three and one that does not count.
using Floats = float __attribute__((vector_size(16)));
using Masks = std::int32_t __attribute__((vector_size(16)));

Heights heights_inside(ImageView<const float> height_mm, const Cell& centre, double z_mm,
                       double tolerance_mm) noexcept {
  constexpr Masks kCounts{-1, -1, -1, 0};
  const auto tolerance = static_cast<float>(tolerance_mm);
  Masks count{};
  Masks above{};
  Masks below{};
  Floats nearest = Floats{} + std::numeric_limits<float>::infinity();
  Floats how_near = nearest;
  for (int y = centre.row - 1; y <= centre.row + 1; ++y) {
    Floats d;
    __builtin_memcpy(&d, height_mm.row(y) + centre.column - 1, sizeof d);
    d -= static_cast<float>(z_mm);
    count += (d == d) & kCounts;  // NaN is missing, and in no order to anything
    above += (d > tolerance) & kCounts;
    below += (d < -tolerance) & kCounts;
    const Floats off = d < 0.0F ? -d : d;
    const Masks is_nearer = (off < how_near) & kCounts;
    how_near = is_nearer ? off : how_near;
    nearest = is_nearer ? d : nearest;
  }
  Heights out;
  out.count = -(count[0] + count[1] + count[2]);
  out.above_count = -(above[0] + above[1] + above[2]);
  out.below_count = -(below[0] + below[1] + below[2]);
  int best = how_near[1] < how_near[0] ? 1 : 0;
  best = how_near[2] < how_near[best] ? 2 : best;
  out.nearest_mm = nearest[best];
  return out;
}

}  // namespace

Cell cell_at(const rectify::Grid& grid, double x_mm, double y_mm) noexcept {
  return {rounded(grid.column_of(x_mm)), rounded(grid.row_of(y_mm))};
}

Look look(const refine::FineImages& images, const Vec3& p_mm, double middle_tolerance_mm,
          double nearest_tolerance_mm) noexcept {
  const Cell centre = cell_at(images.grid, p_mm.x, p_mm.y);
  const ImageView<const float>& height_mm = images.height_mm;
  const bool is_inside = centre.column >= 1 && centre.column + 2 < height_mm.width_px &&
                         centre.row >= 1 && centre.row + 1 < height_mm.height_px;
  const auto heights = is_inside ? heights_inside : heights_at_the_rim;
  const Heights seen = heights(height_mm, centre, p_mm.z, middle_tolerance_mm);
  if (seen.count == 0) {
    const DarkSides sides = dark_sides(images, centre, p_mm.z);
    return {sight_in_the_dark(sides, middle_tolerance_mm),
            sight_in_the_dark(sides, nearest_tolerance_mm)};
  }
  // In ascending order the middle one has the index count / 2.
  Look out{Sight::kAt, sight_of(seen.nearest_mm, nearest_tolerance_mm)};
  if (seen.above_count >= seen.count - seen.count / 2) out.middle = Sight::kAbove;
  if (seen.below_count > seen.count / 2) out.middle = Sight::kBelow;
  return out;
}

}  // namespace flatpose::locate
