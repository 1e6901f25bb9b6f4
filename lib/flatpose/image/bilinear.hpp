#pragma once
// Bilinear interpolation with its derivatives. Continuous; the derivative jumps from cell to cell.

#include <cassert>

#include "flatpose/core/image_view.hpp"
#include "flatpose/image/sample.hpp"

namespace flatpose::image {

/// A place between four pixels, found once for all images of one shape.
/// Units: coordinates in cells, whole numbers at cell centres.  Thread: reentrant.
class BilinearPlace {
 public:
  BilinearPlace(double x, double y, int width_px, int height_px) noexcept {
    assert(width_px > 0 && height_px > 0);
    const ClampedCoordinate cx = clamp_coordinate(x, width_px);
    const ClampedCoordinate cy = clamp_coordinate(y, height_px);
    column_ = cell_of(cx.at, width_px);
    row_ = cell_of(cy.at, height_px);
    right_ = width_px > 1 ? column_ + 1 : column_;
    below_ = height_px > 1 ? row_ + 1 : row_;
    u_ = cx.at - column_;
    v_ = cy.at - row_;
    inside_x_ = cx.inside;
    inside_y_ = cy.inside;
  }

  /// Value and gradient; outside the image the nearest border's value with no slope across it.
  /// Cost: 4 pixels.
  template <class Pixel>
  [[nodiscard]] Sample operator()(ImageView<const Pixel> image) const noexcept {
    const auto at = [&image](int c, int r) { return static_cast<double>(image(c, r)); };
    const double top_slope = at(right_, row_) - at(column_, row_);
    const double bottom_slope = at(right_, below_) - at(column_, below_);
    const double top = at(column_, row_) + u_ * top_slope;
    const double bottom = at(column_, below_) + u_ * bottom_slope;
    return {top + v_ * (bottom - top),
            inside_x_ ? top_slope + v_ * (bottom_slope - top_slope) : 0.0,
            inside_y_ ? bottom - top : 0.0};
  }

 private:
  // The last cell belongs to the interval before it, so that its right neighbour exists.
  static int cell_of(double at, int size_px) noexcept {
    const int i = static_cast<int>(at);
    return i > 0 && i >= size_px - 1 ? size_px - 2 : i;
  }

  int column_, row_, right_, below_;
  double u_, v_;
  bool inside_x_, inside_y_;
};

/// Value and gradient at (x, y); outside the image the nearest border's value with no slope across
/// it.
/// Shape: image not empty.  Units: coordinates in cells, whole numbers at cell centres.
/// Cost: 4 pixels.  Thread: reentrant.
template <class Pixel>
[[nodiscard]] Sample bilinear_sample(ImageView<const Pixel> image, double x, double y) noexcept {
  return BilinearPlace(x, y, image.width_px, image.height_px)(image);
}

/// The same as a T: double, or a dual number with its derivatives.
template <class Pixel, class T>
[[nodiscard]] T bilinear(ImageView<const Pixel> image, const T& x, const T& y) noexcept {
  return lift(bilinear_sample(image, scalar_part(x), scalar_part(y)), x, y);
}

}  // namespace flatpose::image
