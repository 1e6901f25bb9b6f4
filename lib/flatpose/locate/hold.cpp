#include "flatpose/locate/hold.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/refine/small_matrix.hpp"

namespace flatpose::locate {
namespace {

void add_square(const std::array<double, 3>& g, double weight,
                std::array<std::array<double, 3>, 3>& sum) noexcept {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum[i][j] += weight * g[i] * g[j];
}

}  // namespace

Hold::Hold(const model::Template& part) noexcept {
  if (part.contour_count == 0) return;
  const bool turns_freely = part.symmetry.order == model::kFullSymmetry;
  const auto points = part.contour_points();
  for (const model::ContourPoint& p : points) {
    middle_x_mm_ += static_cast<double>(p.x_mm) / static_cast<double>(points.size());
    middle_y_mm_ += static_cast<double>(p.y_mm) / static_cast<double>(points.size());
  }
  if (!turns_freely && part.radius_mm > 0.0) per_radius_ = 1.0 / part.radius_mm;
  for (const model::ContourPoint& p : points) add_square(gradient(p), 1.0, whole_);
}

Hold::Row Hold::gradient(const model::ContourPoint& p) const noexcept {
  const double rx = p.x_mm - middle_x_mm_;
  const double ry = p.y_mm - middle_y_mm_;
  return {p.nx, p.ny, per_radius_ * (rx * p.ny - ry * p.nx)};
}

void Hold::add(const model::ContourPoint& p, double confirmed) noexcept {
  add_square(gradient(p), confirmed, confirmed_);
}

double Hold::least_share() const noexcept {
  // H = V D V^T; in the coordinates u = D^1/2 V^T h the whole contour holds every direction by one.
  refine::Matrix<3> whole;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) whole(i, j) = whole_[i][j];
  const refine::Eigenvalues<3> axes = refine::symmetric_eigenvalues<3>(whole);
  double largest = 0.0;
  for (int k = 0; k < 3; ++k) largest = std::max(largest, axes.values[k]);
  constexpr double kHeldMin = 1e-4;
  refine::Matrix<3> share = refine::Matrix<3>::Zero();
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      const bool is_held =
          axes.values[k] > kHeldMin * largest && axes.values[l] > kHeldMin * largest;
      if (!is_held) {
        share(k, l) = k == l ? 1.0 : 0.0;
        continue;
      }
      double sum = 0.0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          sum += axes.vectors(i, k) * confirmed_[i][j] * axes.vectors(j, l);
      share(k, l) = sum / std::sqrt(axes.values[k] * axes.values[l]);
    }
  }
  const refine::Eigenvalues<3> shares = refine::symmetric_eigenvalues<3>(share);
  double least = 1.0;
  for (int k = 0; k < 3; ++k) least = std::min(least, shares.values[k]);
  return std::max(0.0, least);
}

}  // namespace flatpose::locate
