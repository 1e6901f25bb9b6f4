#pragma once
// How firmly the contour that a scan confirms holds the part in its plane, against what the whole
// contour would.
//
// A gap along the normal n at the point r moves with the part's shift and turn by g = (nx, ny, (r x
// n)_z / R), so the whole contour holds it with H = sum g g^T and what is confirmed, by shares a,
// with C = sum a g g^T. Their ratio in the direction held worst is the least eigenvalue of H^-1 C:
// 1 when all is confirmed, 0 when the part could slide or turn and nothing seen would change. A
// strip with both ends covered is such a part.

#include <array>

#include "flatpose/model/template.hpp"

namespace flatpose::locate {

class Hold {
 public:
  /// Of no contour at all: everything is held.
  Hold() noexcept = default;
  explicit Hold(const model::Template& part) noexcept;

  /// Counts a contour point, confirmed by a share of 0 to 1.
  void add(const model::ContourPoint& p, double confirmed) noexcept;
  /// The share by which the direction held worst is held, 0 to 1. A direction that the whole
  /// contour does not hold (the turn of a disc) is left out.
  [[nodiscard]] double least_share() const noexcept;

 private:
  using Row = std::array<double, 3>;
  [[nodiscard]] Row gradient(const model::ContourPoint& p) const noexcept;

  double middle_x_mm_ = 0.0;
  double middle_y_mm_ = 0.0;
  double per_radius_ = 0.0;  ///< 1 / R; 0: a turn changes nothing.
  std::array<Row, 3> whole_{};
  std::array<Row, 3> confirmed_{};
};

}  // namespace flatpose::locate
