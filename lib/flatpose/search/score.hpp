#pragma once
// The cost of a hypothesis on the coarse level: Ingberg's edge-chamfer and normal residuals
// (2015, 2.6.1, 2.6.2) or, in place of the normals, a height residual (5.3), as one sum of small
// integers. Lower is better. This scalar form is the definition: whatever computes it faster must
// equal it in every bit.
//
// A hypothesis is a place (where an anchor of the template lies) and an angle. The tilt is read off
// the surface at the place, to the nearest of a few bins: within one bin and at one angle every
// template point has a fixed offset and a fixed height against the place.
//
//   edge     min(chamfer distance to an edge that falls the same way, kEdgeCostMax) / cos(tilt)
//            (the tilt-angle bias); at most half where something higher stands
//   surface  min(|z - expected|, cap) in units of height; half of it where something higher stands
//            or: min(|n - expected|, cap) in units of a normal's component
// A point outside the field counts half: it says nothing.

#include <algorithm>
#include <array>
#include <cstdint>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/search/search_images.hpp"

namespace flatpose::search {

inline constexpr int kSparsePointCountMax = 32;
/// Costs saturate here. Sums of the points of one kind stay below it (see kContourCountMax).
inline constexpr std::int32_t kCostMax = 255;
inline constexpr std::int32_t kEdgeFactorMax_q8 = 512;
inline constexpr int kContourCountMax = kCostMax / kEdgeCostMax;
inline constexpr int kSurfaceCountMax = kCostMax / kSurfaceCostMax;

/// How many points the cost looks at, and how.
struct ScoreConfig {
  int contour_count = 16;  ///< Of the sparse set, 0..kContourCountMax; time grows with them.
  int surface_count = 12;  ///< 0..kSurfaceCountMax; as above.
};

/// The sparse template turned to one angle and tilt, relative to the place, in cells and units.
struct ProjectedTemplate {
  struct Contour {
    std::int16_t dx = 0;
    std::int16_t dy = 0;
    std::int16_t octant = 0;
    std::int16_t rise_unit = 0;  ///< Height above the place.
  };
  struct Surface {
    std::int16_t dx = 0;
    std::int16_t dy = 0;
    std::int16_t rise_unit = 0;
    std::int16_t normal_x_unit = 0;  ///< As stored in the images, kNormalZero for upright.
    std::int16_t normal_y_unit = 0;
  };
  int contour_count = 0;
  int surface_count = 0;
  std::int32_t edge_factor_q8 = 256;  ///< 256 / cos(tilt), at most kEdgeFactorMax_q8.
  std::array<Contour, kContourCountMax> contour{};
  std::array<Surface, kSurfaceCountMax> surface{};
};

/// Turns the sparse template to `angle_rad` on a plane of the given slopes. Points farther from the
/// anchor than the lattice's margin are left out.
[[nodiscard]] ProjectedTemplate project(const model::Template& part, const model::Anchor& anchor,
                                        double slope_x, double slope_y, double angle_rad,
                                        const SearchImages& images,
                                        const ScoreConfig& config) noexcept;

/// The largest cost that `projected` can have, before it saturates.
[[nodiscard]] std::int32_t cost_max(const SearchImages& images,
                                    const ProjectedTemplate& projected) noexcept;

/// The height that a point is expected at, given that of the place.
[[nodiscard]] constexpr std::int32_t expected_unit(std::int32_t place_unit,
                                                   std::int32_t rise_unit) noexcept {
  return std::clamp(place_unit + rise_unit, 0, kHeightUnitMax);
}

/// The cost of one hypothesis, at most kCostMax. `place_unit` is the height at the place.
[[nodiscard]] std::int32_t cost(const SearchImages& images, const ProjectedTemplate& projected,
                                int column, int row, std::int32_t place_unit) noexcept;

}  // namespace flatpose::search
