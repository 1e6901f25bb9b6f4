#include "flatpose/locate/sigma.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/refine/polish.hpp"

namespace flatpose::locate {

Sigma sigma_of(const Rotation& face_R_axes, const std::array<double, 36>& covariance) noexcept {
  const auto c = [&covariance](int i, int j) { return covariance[6 * i + j]; };
  const auto variance_along = [&](int axis) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        sum += face_R_axes.m[3 * axis + i] * c(3 + i, 3 + j) * face_R_axes.m[3 * axis + j];
    return sum;
  };
  return {
      {std::sqrt(variance_along(0)), std::sqrt(variance_along(1)), std::sqrt(variance_along(2))},
      {std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2))}};
}

Sigma sigma_of(const Match& match, const Pose& object_T_other) noexcept {
  refine::Matrix<6> kept;
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) kept(i, j) = kept(j, i) = match.covariance[at++];
  const refine::Matrix<6> seen = refine::covariance_seen_from(kept, object_T_other);
  std::array<double, 36> rows;
  // The kept numbers are rounded: a variance of nothing may come out a little below it.
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) rows[6 * i + j] = i == j ? std::max(seen(i, j), 0.0) : seen(i, j);
  Sigma sigma = sigma_of(match.face_T_object.rotation * object_T_other.rotation, rows);
  for (double* value : {&sigma.mm.x, &sigma.mm.y, &sigma.mm.z})
    if (!(*value >= 0.0)) *value = 0.0;
  return sigma;
}

}  // namespace flatpose::locate
