#pragma once
// Cubic B-spline with the pixels themselves as coefficients (Ingberg 2015, sec. 2.7.1, without the
// prefilter of Unser 1999): twice continuously differentiable whatever the pixels are.
//
//   f(x, y) = sum_k sum_l c(k, l) b(x - k) b(y - l)                                   (eq. 2.5)
//
// It does not pass through the pixels but smooths them: a plane stays as it is, a second
// derivative f'' lifts the value by f'' / 6 an axis. In return a sample needs the 16 pixels around
// it and no pass over the image, which may be of bytes. The image goes on mirrored about its border
// cells' centres.

#include <array>
#include <cassert>

#include "flatpose/core/image_view.hpp"
#include "flatpose/image/sample.hpp"

namespace flatpose::image {

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

/// The indices of the four pixels around a place between `index` and `index` + 1.
[[nodiscard]] inline std::array<int, 4> pixels_around(int index, int size_px) noexcept {
  if (index >= 1 && index + 2 < size_px) return {index - 1, index, index + 1, index + 2};
  return {mirrored(index - 1, size_px), mirrored(index, size_px), mirrored(index + 1, size_px),
          mirrored(index + 2, size_px)};
}

/// Value and gradient of the spline at (x, y); outside the image the nearest border's value with no
/// slope across it.
/// Shape: an Image has width_px, height_px, both positive, and (column, row) for a pixel.
/// Units: coordinates in cells, whole numbers at cell centres.  Cost: 16 pixels.
/// Thread: reentrant.
template <class Image>
[[nodiscard]] inline Sample bspline_sample(const Image& image, double x, double y) noexcept {
  assert(image.width_px > 0 && image.height_px > 0);
  const ClampedCoordinate cx = clamp_coordinate(x, image.width_px);
  const ClampedCoordinate cy = clamp_coordinate(y, image.height_px);
  const int column = static_cast<int>(cx.at);
  const int row = static_cast<int>(cy.at);
  const BsplineWeights wx(cx.at - column);
  const BsplineWeights wy(cy.at - row);
  const std::array<int, 4> columns = pixels_around(column, image.width_px);
  const std::array<int, 4> rows = pixels_around(row, image.height_px);
  Sample sample;
  for (int l = 0; l < 4; ++l) {
    double value = 0.0;
    double slope = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double ck = static_cast<double>(image(columns[k], rows[l]));
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
template <class Image, class T>
[[nodiscard]] T bspline(const Image& image, const T& x, const T& y) noexcept {
  return lift(bspline_sample(image, scalar_part(x), scalar_part(y)), x, y);
}

}  // namespace flatpose::image
