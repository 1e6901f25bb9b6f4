#pragma once
// The tilt around every position (Ingberg 2015, 2.8.2), from a plane fitted to a square window
// instead of averaged Sobel normals: the fit's residual also tells where there is no plane at all,
// and only planar places are worth a hypothesis.
//
// For a full window of n = (2r+1)^2 cells with offsets i, j from its centre the normal equations
// are diagonal:
//   (1)  a = sum(i z) / S,  b = sum(j z) / S,  c = sum(z) / n,  S = sum(i^2) = n r (r+1) / 3
//   (2)  residual^2 = sum(z^2) - n c^2 - S (a^2 + b^2)

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"

namespace flatpose::search {

inline constexpr int kTiltWindowRadiusMax_px = 12;

struct TiltField {
  ImageView<float> slope_x;  ///< dz/dx, dimensionless; NaN within the radius of the border.
  ImageView<float> slope_y;
  ImageView<float> plane_mm;  ///< Height of the fitted plane at the cell's centre.
  ImageView<float> rms_mm;    ///< Residual of the fit.
};

[[nodiscard]] TiltField take_tilt_field(Arena& arena, int width_px, int height_px) noexcept;

/// Takes (and leaves taken) the scratch of fit_tilt_field() at its widest window on a map of this
/// width, also from a measuring arena.
void reserve_tilt_scratch(Arena& arena, int width_px) noexcept;

/// Fits a plane around every cell of a filled height map whose column and row are multiples of
/// `stride_px`; other cells of the field stay as they are.
/// Shape: all images alike.  Cost: 8 (2r+1) multiply-adds a cell fitted.  Memory: of `scratch` some
/// 6r + 11 rows of doubles.  Fails: kShapeMismatch, kInvalidArgument (radius outside
/// 1..kTiltWindowRadiusMax_px, stride below 1), kOutOfMemory.  Thread: reentrant.
[[nodiscard]] Status fit_tilt_field(ImageView<const float> filled_mm, double cell_mm, int radius_px,
                                    Arena& scratch, TiltField& field, int stride_px = 1,
                                    VectorPath path = VectorPath::kPortable,
                                    const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::search
