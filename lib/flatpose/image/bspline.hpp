#pragma once
// Cubic B-spline interpolation (Unser 1999; Ingberg 2015, sec. 2.7.1): passes exactly through the
// pixel values and is twice continuously differentiable.
//
//   f(x, y) = sum_k sum_l c(k, l) b(x - k) b(y - l)                                   (eq. 2.5)
//
// The coefficients c come from the pixels by a recursive filter with the pole p = sqrt(3) - 2, once
// forward and once backward along rows, then along columns (eq. 2.7). The image goes on mirrored
// about its border cells' centres.

#include <array>
#include <cassert>

#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/image/sample.hpp"

namespace flatpose::image {

/// Turns pixel values into spline coefficients, in place. `image` may be a part of a larger one.
/// Cost: four passes, linear in cells.  Memory: none.  Thread: reentrant.
void bspline_prefilter(ImageView<float> image) noexcept;

/// An index reflected about the first and the last cell into [0, size_px).
[[nodiscard]] inline int mirrored(int index, int size_px) noexcept {
  if (size_px <= 1) return 0;
  const int period = 2 * (size_px - 1);
  int i = index % period;
  if (i < 0) i += period;
  return i < size_px ? i : period - i;
}

/// The four weights of a cubic B-spline a fraction t in [0, 1] beyond a knot, and their
/// derivatives.
struct BsplineWeights {
  std::array<double, 4> value;
  std::array<double, 4> slope;

  explicit BsplineWeights(double t) noexcept {
    const double s = 1.0 - t;
    value = {s * s * s / 6.0, 2.0 / 3.0 - t * t * (2.0 - t) / 2.0,
             2.0 / 3.0 - s * s * (2.0 - s) / 2.0, t * t * t / 6.0};
    slope = {-s * s / 2.0, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), t * t / 2.0};
  }
};

/// Value and gradient of the spline at (x, y); outside the image the nearest border's value with no
/// slope across it.
/// Shape: coefficients as bspline_prefilter left them, not empty.  Units: coordinates in cells,
/// whole numbers at cell centres.  Cost: 16 pixels.  Thread: reentrant.
[[nodiscard]] inline Sample bspline_sample(ImageView<const float> coefficients, double x,
                                           double y) noexcept {
  assert(!coefficients.empty());
  const ClampedCoordinate cx = clamp_coordinate(x, coefficients.width_px);
  const ClampedCoordinate cy = clamp_coordinate(y, coefficients.height_px);
  const int column = static_cast<int>(cx.at);
  const int row = static_cast<int>(cy.at);
  const BsplineWeights wx(cx.at - column);
  const BsplineWeights wy(cy.at - row);
  std::array<int, 4> columns;
  for (int k = 0; k < 4; ++k) columns[k] = mirrored(column - 1 + k, coefficients.width_px);
  Sample sample;
  for (int l = 0; l < 4; ++l) {
    const float* c = coefficients.row(mirrored(row - 1 + l, coefficients.height_px));
    double value = 0.0;
    double slope = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double ck = static_cast<double>(c[columns[k]]);
      value += wx.value[k] * ck;
      slope += wx.slope[k] * ck;
    }
    sample.value += wy.value[l] * value;
    sample.slope_x += wy.value[l] * slope;
    sample.slope_y += wy.slope[l] * value;
  }
  if (!cx.inside) sample.slope_x = 0.0;
  if (!cy.inside) sample.slope_y = 0.0;
  return sample;
}

/// The same as a T: double, or a dual number with its derivatives.
template <class T>
[[nodiscard]] T bspline(ImageView<const float> coefficients, const T& x, const T& y) noexcept {
  return lift(bspline_sample(coefficients, scalar_part(x), scalar_part(y)), x, y);
}

}  // namespace flatpose::image
