#pragma once
// Bilinear interpolation with its derivatives. Continuous; the derivative jumps from cell to cell.

#include <cassert>

#include "flatpose/core/image_view.hpp"
#include "flatpose/image/sample.hpp"

namespace flatpose::image {

/// Value and gradient at (x, y); outside the image the nearest border's value with no slope across
/// it.
/// Shape: image not empty.  Units: coordinates in cells, whole numbers at cell centres.
/// Cost: 4 pixels.  Thread: reentrant.
template <class Pixel>
[[nodiscard]] Sample bilinear_sample(ImageView<const Pixel> image, double x, double y) noexcept {
  assert(!image.empty());
  const ClampedCoordinate cx = clamp_coordinate(x, image.width_px);
  const ClampedCoordinate cy = clamp_coordinate(y, image.height_px);
  // The last cell belongs to the interval before it, so that its right neighbour exists.
  const auto cell_of = [](double at, int size_px) {
    const int i = static_cast<int>(at);
    return i > 0 && i >= size_px - 1 ? size_px - 2 : i;
  };
  const int column = cell_of(cx.at, image.width_px);
  const int row = cell_of(cy.at, image.height_px);
  const int right = image.width_px > 1 ? column + 1 : column;
  const int below = image.height_px > 1 ? row + 1 : row;
  const double u = cx.at - column;
  const double v = cy.at - row;
  const auto at = [&](int c, int r) { return static_cast<double>(image(c, r)); };
  const double top_slope = at(right, row) - at(column, row);
  const double bottom_slope = at(right, below) - at(column, below);
  const double top = at(column, row) + u * top_slope;
  const double bottom = at(column, below) + u * bottom_slope;
  return {top + v * (bottom - top), cx.inside ? top_slope + v * (bottom_slope - top_slope) : 0.0,
          cy.inside ? bottom - top : 0.0};
}

/// The same as a T: double, or a dual number with its derivatives.
template <class Pixel, class T>
[[nodiscard]] T bilinear(ImageView<const Pixel> image, const T& x, const T& y) noexcept {
  return lift(bilinear_sample(image, scalar_part(x), scalar_part(y)), x, y);
}

}  // namespace flatpose::image
