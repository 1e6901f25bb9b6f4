#pragma once
// How the contour's normals are spread over the plane: what holds a part in each direction.

#include "flatpose/model/template.hpp"

namespace flatpose::model {

/// The sum of n n^T over the contour.
struct NormalSpread {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
};

[[nodiscard]] inline NormalSpread normal_spread(const Template& part) noexcept {
  NormalSpread sum;
  for (const ContourPoint& p : part.contour_points()) {
    sum.xx += static_cast<double>(p.nx) * p.nx;
    sum.xy += static_cast<double>(p.nx) * p.ny;
    sum.yy += static_cast<double>(p.ny) * p.ny;
  }
  return sum;
}

}  // namespace flatpose::model
