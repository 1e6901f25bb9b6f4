#pragma once
// The axis that a part's contour turns about, and whether it looks alike after a turn.

#include "flatpose/model/template.hpp"

namespace flatpose::teach {

/// The contour's own centre of the declared symmetry: where its normals meet (full), or where a
/// turn by 360 / N lays it onto itself best. The middle of the contour for a part without symmetry.
[[nodiscard]] Vec3 symmetry_center(const model::Template& part) noexcept;

/// Share of the contour that a turn about (x, y) lays within `tolerance_mm` of the contour, facing
/// the same way.
[[nodiscard]] double overlap_after_turn(const model::Template& part, double x_mm, double y_mm,
                                        double angle_rad, double tolerance_mm) noexcept;

/// The highest order of symmetry that the contour shows about its middle; 1: none, kFullSymmetry:
/// any turn.
[[nodiscard]] int likely_symmetry(const model::Template& part, double tolerance_mm) noexcept;

}  // namespace flatpose::teach
