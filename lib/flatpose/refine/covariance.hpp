#pragma once
// How well least squares holds its parameters, and which it does not hold at all.
//
// With residuals of variance s^2 / w_k the solution varies with
//
//   C = s^2 H^-1,      H = J^T W J.                                                         (1)
//
// H is first made free of units, A = S H S with S = diag(1 / sqrt(H_ii)) (1 where H_ii = 0), then
// decomposed, A = sum_k lambda_k u_k u_k^T. Directions with lambda_k <= eps max(lambda) are free:
// the cost does not tell points along S u_k apart. On the others
//
//   C = s^2 S (sum_k u_k u_k^T / lambda_k) S,                                               (2)
//
// which is (1) when no direction is free. Parameter i takes part in free directions with the share
// sum_k u_ki^2, from 0 (held) to 1 (wholly free).

#include <cmath>

#include "flatpose/core/result.hpp"
#include "flatpose/refine/small_matrix.hpp"

namespace flatpose::refine {

template <int N>
struct Covariance {
  Matrix<N> matrix = Matrix<N>::Zero();           ///< Equation (2).
  int rank = 0;                                   ///< N minus the count of free directions.
  Matrix<N> free_directions = Matrix<N>::Zero();  ///< The first N - rank columns, of unit length.
  Vector<N> free_share = Vector<N>::Zero();       ///< Of each parameter.

  [[nodiscard]] bool is_full_rank() const noexcept { return rank == N; }
  /// Whether the standard deviation of this parameter means anything.
  [[nodiscard]] bool is_held(int parameter) const noexcept { return free_share[parameter] < 1e-6; }
  [[nodiscard]] double standard_deviation(int parameter) const noexcept {
    return std::sqrt(matrix(parameter, parameter));
  }
};

inline constexpr double kRankTolerance = 1e-12;  // of A, thus 1e-6 of the Jacobian's columns

template <int N>
void add_free_direction(const Vector<N>& direction, Covariance<N>* out) noexcept {
  const double length = std::sqrt(dot<N>(direction, direction));
  const int column = N - out->rank;
  for (int i = 0; i < N; ++i) out->free_directions(i, column) = direction[i] / length;
}

/// The covariance of the parameters from the Hessian at the solution (a symmetric matrix).
/// Fails: kNotFinite, kInvalidArgument (variance or tolerance below 0, H_ii below 0).  A singular
/// Hessian is no failure: see Covariance::rank.  Cost: about 20 N^3.
template <int N>
[[nodiscard]] Result<Covariance<N>> covariance(const Matrix<N>& hessian, double variance = 1.0,
                                               double rank_tolerance = kRankTolerance) noexcept {
  if (!std::isfinite(variance)) return Status::kNotFinite;
  if (variance < 0.0 || !(rank_tolerance >= 0.0)) return Status::kInvalidArgument;
  Vector<N> scale;
  for (int i = 0; i < N; ++i) {
    if (hessian(i, i) < 0.0) return Status::kInvalidArgument;
    scale[i] = hessian(i, i) > 0.0 ? 1.0 / std::sqrt(hessian(i, i)) : 1.0;
  }
  Matrix<N> scaled;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < N; ++i) {
      scaled(i, j) = scale[i] * hessian(i, j) * scale[j];
      if (!std::isfinite(scaled(i, j))) return Status::kNotFinite;
    }
  }
  const Eigenvalues<N> eigen = symmetric_eigenvalues<N>(scaled);
  double largest = 0.0;
  for (int k = 0; k < N; ++k) largest = eigen.values[k] > largest ? eigen.values[k] : largest;

  Covariance<N> out;
  out.rank = N;
  for (int k = 0; k < N; ++k) {
    Vector<N> direction;  // S u_k
    for (int i = 0; i < N; ++i) direction[i] = scale[i] * eigen.vectors(i, k);
    if (!(eigen.values[k] > rank_tolerance * largest)) {
      add_free_direction<N>(direction, &out);
      --out.rank;
      for (int i = 0; i < N; ++i) out.free_share[i] += eigen.vectors(i, k) * eigen.vectors(i, k);
      continue;
    }
    const double factor = variance / eigen.values[k];
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) out.matrix(i, j) += factor * (direction[i] * direction[j]);
  }
  return out;
}

}  // namespace flatpose::refine
