#pragma once
// What a contour point weighs: as much as its direction is rare. The two ends of a bar are all that
// holds it along its length, however short they are, and a web of a larger part lacks just those.

#include <algorithm>

#include "flatpose/model/normal_spread.hpp"

namespace flatpose::locate {

/// With M = mean(n n^T) over the contour, w = n^T M^-1 n / 2 makes every direction in the plane
/// weigh the same and the mean weight one.
class DirectionWeight {
 public:
  explicit DirectionWeight(const model::Template& part) noexcept {
    const auto [xx, xy, yy] = model::normal_spread(part);
    const double count = std::max(1, part.contour_count);
    const double determinant = (xx * yy - xy * xy) / (count * count);
    constexpr double kParallel = 0.01;  // contours of hardly more than one direction weigh alike
    if (determinant < kParallel) return;
    inverse_xx_ = 0.5 * yy / count / determinant;
    inverse_xy_ = -0.5 * xy / count / determinant;
    inverse_yy_ = 0.5 * xx / count / determinant;
  }
  [[nodiscard]] double operator()(const model::ContourPoint& p) const noexcept {
    const double nx = p.nx;
    const double ny = p.ny;
    return inverse_xx_ * nx * nx + 2.0 * inverse_xy_ * nx * ny + inverse_yy_ * ny * ny;
  }

 private:
  double inverse_xx_ = 1.0;
  double inverse_xy_ = 0.0;
  double inverse_yy_ = 1.0;
};

}  // namespace flatpose::locate
