#pragma once
// The sums of weighted least squares, one residual at a time, so that no Jacobian is ever stored.
//
//   F = sum_k w_k rho_k(r_k)                 cost                                           (1)
//   g = sum_k w_k omega_k r_k J_k^T          gradient of F, exactly                         (2)
//   H = sum_k w_k omega_k J_k^T J_k          Gauss-Newton Hessian of F, J^T W J             (3)
//   q = sum_k w_k omega_k r_k^2              weighted square sum                            (4)
//
// J_k is the row of first derivatives of the residual r_k, w_k >= 0 the caller's weight (one over
// the variance where that is known), rho and omega those of RobustLoss. Everything is added in the
// order of the calls: the same calls in the same order give the same bits.

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "flatpose/autodiff/dual.hpp"
#include "flatpose/refine/robust_loss.hpp"
#include "flatpose/refine/small_matrix.hpp"

namespace flatpose::refine {

/// Sums over residuals of M parameters, ready to be added.
template <std::size_t M>
struct SparseSums {
  double cost = 0.0;
  double square_sum = 0.0;
  double weight_sum = 0.0;
  int residual_count = 0;
  std::array<double, M> gradient{};
  std::array<std::array<double, M>, M> hessian_lower{};  ///< [row][column], row >= column.
};

template <int N>
class NormalEquations {
 public:
  NormalEquations() noexcept { reset(); }

  void reset() noexcept {
    hessian_lower_.setZero();
    gradient_.setZero();
    cost_ = square_sum_ = weight_sum_ = 0.0;
    residual_count_ = 0;
  }

  /// Adds one residual with its row of derivatives.  Cost: N (N + 5) / 2 multiply-adds.
  void add(double residual, const Vector<N>& row, double weight = 1.0,
           const RobustLoss& loss = {}) noexcept {
    const LossValue at = loss(residual);
    cost_ += weight * at.cost;
    add_weighted(residual, row, weight * at.weight);
    ++residual_count_;
  }

  /// The same; `row_of()` is asked for the row only where the loss believes the residual, so that
  /// a row that is not finite goes unnoticed elsewhere.
  template <class RowOf>
  void add_lazily(double residual, RowOf&& row_of, double weight, const RobustLoss& loss) noexcept {
    const LossValue at = loss(residual);
    cost_ += weight * at.cost;
    ++residual_count_;
    const double believed = weight * at.weight;
    if (believed == 0.0) {
      square_sum_ += believed * residual;  // NaN for an infinite one
      return;
    }
    add_weighted(residual, row_of(), believed);
  }

  /// Adds many residuals by their sums, (1) to (4), of which only the parameters `kParameters`, in
  /// rising order, have derivatives.
  template <int... kParameters>
  void add_summed(const SparseSums<sizeof...(kParameters)>& sums) noexcept {
    constexpr std::array<int, sizeof...(kParameters)> at_index{kParameters...};
    for (std::size_t j = 0; j < at_index.size(); ++j) {
      gradient_[at_index[j]] += sums.gradient[j];
      for (std::size_t i = j; i < at_index.size(); ++i)
        hessian_lower_(at_index[i], at_index[j]) += sums.hessian_lower[i][j];
    }
    cost_ += sums.cost;
    square_sum_ += sums.square_sum;
    weight_sum_ += sums.weight_sum;
    residual_count_ += sums.residual_count;
  }

  /// Adds a residual of which only that the loss rejects it is known, and what it costs.
  void add_rejected(double cost) noexcept {
    cost_ += cost;
    ++residual_count_;
  }

  /// The same, the row being the derivatives of a dual number.
  void add(const autodiff::Dual<N>& residual, double weight = 1.0,
           const RobustLoss& loss = {}) noexcept {
    add(residual.value, Vector<N>(residual.derivative.data()), weight, loss);
  }

  /// Adds what is known beforehand: `parameter` is `deviation` away from its expected value, with
  /// `information` = 1 / variance. It enters (1) to (4), but neither the count nor the sum of
  /// weights.
  void add_prior(int parameter, double deviation, double information) noexcept {
    assert(parameter >= 0 && parameter < N && !(information < 0.0));
    cost_ += information * 0.5 * deviation * deviation;
    square_sum_ += information * deviation * deviation;
    gradient_[parameter] += information * deviation;
    hessian_lower_(parameter, parameter) += information;
  }

  [[nodiscard]] double cost() const noexcept { return cost_; }
  [[nodiscard]] const Vector<N>& gradient() const noexcept { return gradient_; }
  [[nodiscard]] double hessian(int i, int j) const noexcept {
    return i < j ? hessian_lower_(j, i) : hessian_lower_(i, j);
  }
  [[nodiscard]] Matrix<N> hessian() const noexcept {
    Matrix<N> full;
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) full(i, j) = hessian(i, j);
    return full;
  }
  [[nodiscard]] double square_sum() const noexcept { return square_sum_; }
  [[nodiscard]] double weight_sum() const noexcept { return weight_sum_; }  ///< sum of w omega
  [[nodiscard]] int residual_count() const noexcept { return residual_count_; }

  /// NaN and infinity stay in a sum once they are in it, so the sums alone tell; an infinite
  /// residual under a loss that levels off too, for 0 times infinity is NaN.
  [[nodiscard]] bool is_finite() const noexcept {
    for (int j = 0; j < N; ++j)
      for (int i = j; i < N; ++i)
        if (!std::isfinite(hessian_lower_(i, j))) return false;
    return std::isfinite(cost_) && std::isfinite(square_sum_) && refine::is_finite<N>(gradient_);
  }

 private:
  void add_weighted(double residual, const Vector<N>& row, double weight) noexcept {
    assert(!(weight < 0.0));
    const double weighted_residual = weight * residual;
    for (int i = 0; i < N; ++i) gradient_[i] += weighted_residual * row[i];
    for (int j = 0; j < N; ++j) {
      const double weighted = weight * row[j];
      // From an even row on, so that pairs stay pairs; what is above the diagonal is never read.
      for (int i = j & ~1; i < N; ++i) hessian_lower_(i, j) += weighted * row[i];
    }
    square_sum_ += weighted_residual * residual;
    weight_sum_ += weight;
  }

  Matrix<N> hessian_lower_;
  Vector<N> gradient_;
  double cost_ = 0.0;
  double square_sum_ = 0.0;
  double weight_sum_ = 0.0;
  int residual_count_ = 0;
};

}  // namespace flatpose::refine
