#pragma once
// A part: an outline pulled to a thickness, with areas of its top raised or recessed, as it would
// come from a press. Its solid is {(x, y, z): (x, y) in the outline, -thickness <= z <= height(x,
// y)} where height is 0 but on the areas.
//
// Object frame: origin at the centroid of the outline (holes taken off) on the top plane, x and y
// as drawn, z up out of the top.

#include <optional>
#include <string>
#include <vector>

#include "port/sim/outline.hpp"

namespace flatpose::sim {

/// Outer loop, holes and areas together, so that a set of them fits a word.
inline constexpr int kLoopsMax = 63;

struct Area {
  Loop loop;         ///< Inside the outer loop; may reach over a hole, which stays a hole.
  double height_mm;  ///< Over the top plane; below 0 a recess, which must not pass the thickness.
};

struct Part {
  std::string name;
  Outline outline;
  double thickness_mm = 0.0;
  std::vector<Area> areas;  ///< Where two overlap the later one holds.
  int symmetry_fold = 1;    ///< Turns about the origin that leave it as it is; 0: every turn.
};

/// The part with its origin moved to the centroid.
/// Fails: std::invalid_argument (fewer than three points, clockwise loops, thickness, recess, more
/// than kLoopsMax loops).
[[nodiscard]] Part make_part(Part as_drawn);

/// The names in the order of the catalogue.
[[nodiscard]] const std::vector<std::string>& part_names();
/// A part of the catalogue.  Fails: std::invalid_argument that lists the names.
[[nodiscard]] Part catalogue_part(const std::string& name);

[[nodiscard]] double area_mm2(const Part& part) noexcept;
[[nodiscard]] double contour_length_mm(const Part& part) noexcept;
[[nodiscard]] bool contains(const Part& part, Vec2 p_mm) noexcept;
/// Height of the top over the top plane; none where there is no part.
[[nodiscard]] std::optional<double> top_height_mm(const Part& part, Vec2 p_mm) noexcept;
/// The same along a line of constant y: the work of each edge is done once, not for every point.
class TopRow {
 public:
  TopRow(const Part& part, double y_mm);
  [[nodiscard]] std::optional<double> height_mm(double x_mm) const noexcept;

 private:
  using Crossings = std::vector<double>;  // x of the edges of a loop
  static Crossings crossings(const Loop& loop, double y_mm);
  static bool is_inside(const Crossings& crossings, double x_mm) noexcept;

  const Part& part_;
  Crossings outer_;
  std::vector<Crossings> holes_;
  std::vector<Crossings> areas_;
};
/// Of the highest area, at least 0.
[[nodiscard]] double height_max_mm(const Part& part) noexcept;
/// Of the smallest circle about the origin that holds the outline.
[[nodiscard]] double radius_mm(const Part& part) noexcept;

}  // namespace flatpose::sim
