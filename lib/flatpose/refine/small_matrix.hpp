#pragma once
// The linear algebra that refinement needs, of a size fixed at compile time.
//
// Eigen's types hold the numbers, but its reductions and decompositions are not used: they add in
// an order that follows the width of the machine's vectors, and fuse where the machine can, so that
// a pose would have other bits on another machine. These loops add from index 0 upward on every
// one. Sums, dot products and decompositions of a caller whose bits count must do so too;
// element-wise expressions such as x + step are safe.

#include <Eigen/Core>
#include <cmath>

namespace flatpose::refine {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

template <int N>
[[nodiscard]] double dot(const Vector<N>& a, const Vector<N>& b) noexcept {
  double sum = 0.0;
  for (int i = 0; i < N; ++i) sum += a[i] * b[i];
  return sum;
}

template <int N>
[[nodiscard]] bool is_finite(const Vector<N>& a) noexcept {
  for (int i = 0; i < N; ++i)
    if (!std::isfinite(a[i])) return false;
  return true;
}

/// Solves a x = b by Cholesky's decomposition; only the lower triangle of `a` is read.
/// Fails: false when `a` is not positive definite or the solution not finite.  Cost: N^3 / 6.
template <int N>
[[nodiscard]] bool solve_positive_definite(Matrix<N> a, const Vector<N>& b, Vector<N>* x) noexcept {
  for (int j = 0; j < N; ++j) {
    double pivot = a(j, j);
    for (int k = 0; k < j; ++k) pivot -= a(j, k) * a(j, k);
    if (!(pivot > 0.0)) return false;
    a(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < N; ++i) {
      double sum = a(i, j);
      for (int k = 0; k < j; ++k) sum -= a(i, k) * a(j, k);
      a(i, j) = sum / a(j, j);
    }
  }
  *x = b;
  for (int i = 0; i < N; ++i) {
    for (int k = 0; k < i; ++k) (*x)[i] -= a(i, k) * (*x)[k];
    (*x)[i] /= a(i, i);
  }
  for (int i = N - 1; i >= 0; --i) {
    for (int k = i + 1; k < N; ++k) (*x)[i] -= a(k, i) * (*x)[k];
    (*x)[i] /= a(i, i);
  }
  return is_finite<N>(*x);
}

template <int N>
struct Eigenvalues {
  Vector<N> values;   ///< In no particular order.
  Matrix<N> vectors;  ///< Column i belongs to value i; orthonormal.
};

/// One turn of Jacobi's method: the rotation in the plane (p, q) that makes a(p, q) zero.
template <int N>
void jacobi_turn(int p, int q, Matrix<N>* a_inout, Matrix<N>* vectors) noexcept {
  Matrix<N>& a = *a_inout;
  if (a(p, q) == 0.0) return;
  const double theta = (a(q, q) - a(p, p)) / (2.0 * a(p, q));
  const double t = (theta < 0.0 ? -1.0 : 1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0);
  const double s = t * c;
  for (int k = 0; k < N; ++k) {
    const double kp = a(k, p), kq = a(k, q);
    a(k, p) = c * kp - s * kq;
    a(k, q) = s * kp + c * kq;
  }
  for (int k = 0; k < N; ++k) {
    const double pk = a(p, k), qk = a(q, k);
    a(p, k) = c * pk - s * qk;
    a(q, k) = s * pk + c * qk;
    const double vp = (*vectors)(k, p), vq = (*vectors)(k, q);
    (*vectors)(k, p) = c * vp - s * vq;
    (*vectors)(k, q) = s * vp + c * vq;
  }
  a(p, q) = a(q, p) = 0.0;
}

/// Eigenvalues of a symmetric matrix by Jacobi's cyclic method, which needs only + - * / and sqrt.
/// Cost: about 6 sweeps of 3 N^3.  Accuracy: a few ulp of the largest.
/// Source: Golub and Van Loan, Matrix Computations, section 8.5.
template <int N>
[[nodiscard]] Eigenvalues<N> symmetric_eigenvalues(Matrix<N> a) noexcept {
  constexpr int kSweepLimit = 30;  // convergence is quadratic; 10 are more than enough
  Eigenvalues<N> out;
  out.vectors.setIdentity();
  for (int sweep = 0; sweep < kSweepLimit; ++sweep) {
    double off_diagonal = 0.0, diagonal = 0.0;
    for (int j = 0; j < N; ++j) {
      diagonal += a(j, j) * a(j, j);
      for (int i = 0; i < j; ++i) off_diagonal += a(i, j) * a(i, j);
    }
    if (!(off_diagonal > 1e-36 * diagonal)) break;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) jacobi_turn<N>(p, q, &a, &out.vectors);
  }
  for (int i = 0; i < N; ++i) out.values[i] = a(i, i);
  return out;
}

}  // namespace flatpose::refine
