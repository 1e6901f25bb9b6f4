#pragma once
// The plane that most of a part's surface lies in, whatever else stands on it.

#include <span>

#include "flatpose/geometry/vec3.hpp"

namespace flatpose::teach {

struct Plane {
  double slope_x = 0.0;  ///< z = offset + slope_x x + slope_y y
  double slope_y = 0.0;
  double offset_mm = 0.0;

  [[nodiscard]] double z_at(double x_mm, double y_mm) const noexcept {
    return offset_mm + slope_x * x_mm + slope_y * y_mm;
  }
  [[nodiscard]] Vec3 normal() const noexcept { return normalized({-slope_x, -slope_y, 1.0}); }
};

/// A place on the surface with the slopes of the surface around it.
struct SurfaceSample {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double z_mm = 0.0;
  double slope_x = 0.0;
  double slope_y = 0.0;
};

/// Median of the slopes, then the height that most samples share, then least squares over those
/// near it. Shape: at least three samples.  `scratch` holds one value a sample.  Thread: reentrant.
[[nodiscard]] Plane dominant_plane(std::span<const SurfaceSample> samples, double tolerance_mm,
                                   std::span<double> scratch) noexcept;

}  // namespace flatpose::teach
