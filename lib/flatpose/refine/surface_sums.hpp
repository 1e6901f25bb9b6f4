#pragma once
// The least-squares sums of a footprint: all points hold the same three parameters, so their share
// of the normal equations is eleven sums. Eight sums run side by side, whatever the width of the
// machine's vectors, and are added in a fixed order at the end: every path gives the same bits.

#include "flatpose/core/vector_path.hpp"
#include "flatpose/refine/footprint.hpp"

namespace flatpose::refine {

/// A small motion of the part that a surface feels: turns about x and y, a shift along z.
struct SurfaceStep {
  double turn_x_rad = 0.0;
  double turn_y_rad = 0.0;
  double shift_z_mm = 0.0;
};

/// Of the residuals r = above - (y turn_x - x turn_y) - shift_z, believed by Tukey's weight
/// w = u^2, u = 1 - (r / scale)^2, within the scale; none beyond.
struct SurfaceSums {
  double u3 = 0.0;  ///< Tukey's cost is scale^2 / 6 times (count - this).
  double w = 0.0;
  double wx = 0.0;
  double wy = 0.0;
  double wxx = 0.0;
  double wxy = 0.0;
  double wyy = 0.0;
  double wr = 0.0;
  double wrx = 0.0;
  double wry = 0.0;
  double wrr = 0.0;
};

using SumSurface = void (*)(const Footprint& footprint, const SurfaceStep& step, double scale_mm,
                            SurfaceSums& sums) noexcept;

extern const SumSurface kPortableSumSurface;
extern const SumSurface kAvx2SumSurface;
extern const SumSurface kAvx512SumSurface;

[[nodiscard]] SumSurface sum_surface_for(VectorPath path) noexcept;

}  // namespace flatpose::refine
