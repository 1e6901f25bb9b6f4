#pragma once
// From a part's cells to the template's two clouds and its anchors.

#include "flatpose/core/arena.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/scene/scene.hpp"
#include "flatpose/teach/part_mask.hpp"
#include "flatpose/teach/surface_plane.hpp"

namespace flatpose::teach {

inline constexpr int kSampleCountMax = 8192;

/// Smooth places of the part, away from every contour.
struct SurfaceSamples {
  std::span<SurfaceSample> samples;  ///< In the work frame.
  std::span<double> clearance_mm;  ///< Of each: distance to the nearest contour or end of the part.
  double stride_mm = 0.0;          ///< Their spacing.
  int count = 0;
};

/// Takes (and leaves taken) all that the functions below take, also from a measuring arena.
void reserve_cloud_scratch(Arena& arena, const rectify::Grid& grid) noexcept;

/// Samples the surface.  Fails: kTooFewPoints, kOutOfMemory.
[[nodiscard]] Status sample_surface(const scene::Scene& scene, const PartMask& mask,
                                    double noise_mm, Arena& arena, SurfaceSamples& out) noexcept;

/// Fills part.surface in farthest-point order.  `work_T_object` places the object frame.
[[nodiscard]] Status build_surface_cloud(const SurfaceSamples& samples, const PartMask& mask,
                                         const rectify::Grid& grid, const Pose& work_T_object,
                                         double margin_mm, Arena& scratch,
                                         model::Template& part) noexcept;

/// Fills part.contour in farthest-point order, corners and stray edges left out.  Fails:
/// kNoContour, kOutOfMemory.
[[nodiscard]] Status build_contour_cloud(const scene::Scene& scene, const PartMask& mask,
                                         const Pose& work_T_object, Arena& scratch,
                                         model::Template& part) noexcept;

/// Places the anchors: flat discs on the part's main plane, the first as large as there is.  Fails:
/// kTooFewPoints.
[[nodiscard]] Status place_anchors(const SurfaceSamples& samples, const Pose& work_T_object,
                                   double tolerance_mm, model::Template& part) noexcept;

}  // namespace flatpose::teach
