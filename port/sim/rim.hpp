#pragma once
// What two parts can touch each other with: their rims. The gap between two flat faces is linear
// over the patch they share, so it is smallest where a rim of the one is over the other; points
// along all rims therefore find every contact.

#include <vector>

#include "flatpose/geometry/vec3.hpp"
#include "port/sim/part.hpp"

namespace flatpose::sim {

inline constexpr double kRimStepMm = 1.0;

/// Frames: object.
struct Rims {
  std::vector<Vec3> top_mm;     ///< Along outline, holes and areas, on the higher side of a step.
  std::vector<Vec3> bottom_mm;  ///< Along outline and holes.
};
/// Points at most kRimStepMm apart.
[[nodiscard]] Rims rims(const Part& part);

/// Of the solid of even density, areas counted in.  Frames: object.
[[nodiscard]] Vec3 center_of_mass_mm(const Part& part);

}  // namespace flatpose::sim
