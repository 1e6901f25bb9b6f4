#pragma once
// The cost of a hypothesis on the coarse level: Ingberg's edge-chamfer and normal residuals
// (2015, 2.6.1, 2.6.2) and a height residual (5.3) as one sum of small integers. Lower is better.
// This scalar form is the definition: whatever computes it faster must equal it in every bit.
//
// A hypothesis is a place (where the first anchor lies, with the tilt read off the surface there)
// and an angle. The template is rotated by the nearest of a few tilts (so that every point has a
// fixed offset), while heights follow the slopes of the place itself.
//
//   edge     min(chamfer distance to an edge that falls the same way, kEdgeCostMax) / cos(tilt)
//   (tilt-angle bias) height   min(|z - expected| in steps of a tolerance, kHeightCostMax) normal
//   min(|n - expected| in steps of a tolerance, kNormalCostMax)
// A point outside the field costs half: it says nothing. So does a surface point on missing data or
// hidden under something higher; a contour point on missing data keeps its distance, for shadows
// begin at contours.

#include <array>
#include <cstdint>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/search/search_images.hpp"

namespace flatpose::search {

inline constexpr int kSparsePointCountMax = 32;
inline constexpr int kHeightCostMax = 15;
inline constexpr int kNormalCostMax = 7;

/// How the cost weighs what it sees. Plain numbers, all on one scale.
struct ScoreConfig {
  int contour_count =
      16;  ///< Points of the sparse set, 0..kSparsePointCountMax; time grows with them.
  int surface_count = 12;              ///< As above.
  double height_tolerance_mm = 3.0;    ///< Where the height cost reaches its maximum.
  double normal_tolerance_rad = 0.35;  ///< Where the normal cost reaches its maximum.
  bool use_height = true;              ///< Off: as the thesis has it.
  bool use_directions = true;          ///< Off: any edge serves, whichever way it falls.
};

/// A place on the coarse level with the plane around it.
struct Place {
  std::int16_t column = 0;
  std::int16_t row = 0;
  std::int32_t height_unit = 0;
  std::int32_t slope_x_q8 = 0;  ///< Height units per cell, times 256.
  std::int32_t slope_y_q8 = 0;
  std::int16_t normal_x_unit = 0;
  std::int16_t normal_y_unit = 0;
};

/// The sparse template turned to one angle and tilt, relative to the anchor, in cells and units.
struct ProjectedTemplate {
  struct Contour {
    std::int16_t dx = 0;
    std::int16_t dy = 0;
    std::int16_t octant = 0;
  };
  struct Surface {
    std::int16_t dx = 0;
    std::int16_t dy = 0;
    std::int16_t height_unit = 0;    ///< Above the anchor's plane.
    std::int16_t normal_x_unit = 0;  ///< Difference to the anchor's normal.
    std::int16_t normal_y_unit = 0;
  };
  int contour_count = 0;
  int surface_count = 0;
  std::int32_t edge_factor_q8 = 256;  ///< 256 / cos(tilt)
  std::array<Contour, kSparsePointCountMax> contour{};
  std::array<Surface, kSparsePointCountMax> surface{};
};

/// Integer forms of the tolerances.
struct ScoreScale {
  std::int32_t height_factor_q8 = 0;  ///< Cost per height unit, times 256.
  std::int32_t normal_factor_q8 = 0;
  bool use_height = true;
  bool use_directions = true;
};

[[nodiscard]] ScoreScale score_scale(const ScoreConfig& config) noexcept;

/// Turns the sparse template to `angle_rad` on a plane of the given slopes.
[[nodiscard]] ProjectedTemplate project(const model::Template& part, const model::Anchor& anchor,
                                        double slope_x, double slope_y, double angle_rad,
                                        double cell_mm, const ScoreConfig& config) noexcept;

/// The largest cost that `projected` can have.
[[nodiscard]] std::int32_t cost_max(const ProjectedTemplate& projected,
                                    const ScoreScale& scale) noexcept;

/// The cost of one hypothesis, or any value >= `limit` when it is not below `limit`.
[[nodiscard]] std::int32_t cost(const SearchImages& images, const ProjectedTemplate& projected,
                                const ScoreScale& scale, const Place& place,
                                std::int32_t limit) noexcept;

}  // namespace flatpose::search
