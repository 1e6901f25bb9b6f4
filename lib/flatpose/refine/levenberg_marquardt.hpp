#pragma once
// Levenberg-Marquardt for N parameters, N fixed at compile time, any count of residuals.
//
// Sought is a local minimum of the cost F of NormalEquations, over x or over a manifold on which
// x (+) h moves x by a small step h. Around x the cost is close to the model
//
//   F(x (+) h) ~ F + g^T h + h^T H h / 2                                                    (1)
//
// (g, H: see normal_equations.hpp). Its minimum may lie far outside of where (1) holds, so the step
// is damped in units in which every column of the Jacobian has length one (Marquardt 1963; the
// largest length seen so far, More 1978):
//
//   S = diag(1 / sqrt(D_i)),   D_i = max over accepted x of H_ii,  1 where that is 0        (2)
//   (S H S + mu I) y = -S g,   h = S y                                                      (3)
//
// Multiplying (3) by y^T gives what (1) promises to win, and the gain is what is kept of it:
//
//   L = -(g^T h + h^T H h / 2) = y^T (mu y - S g) / 2                                       (4)
//   gain = (F(x) - F(x (+) h)) / L                                                          (5)
//
// A step with gain > 1e-4 is accepted; the damping follows it smoothly (Nielsen 1999):
//
//   accepted:  mu <- mu max(1/3, 1 - (2 gain - 1)^3),  nu <- 2                              (6)
//   rejected:  mu <- mu nu,                            nu <- 2 nu                           (7)
//
// A trial where the problem is not defined or anything is NaN or infinite is rejected. With a
// robust loss H leaves out rho's curvature, which makes (1) an upper bound for Huber's and Tukey's
// rho, so that a step of (3) is never too long on their account (iteratively reweighted least
// squares).
//
// It ends at the first of these that holds, m_i being |x_i|, or 1 on a manifold:
//
//   kGradientTolerance   |g_i| <= eps_g sqrt(H_ii q) for all i: every column of the         (8)
//                        weighted Jacobian is orthogonal to the residual but for eps_g
//   kStepTolerance       |h_i| <= eps_h (m_i + eps_h) for all i                             (9)
//   kCostTolerance       |F(x) - F(x (+) h)| <= eps_F F(x)  and  L <= eps_F F(x)            (10)
//   kDampingLimit        mu > mu_max                                                        (11)
//   kIterationLimit      count of trial steps >= iteration_limit                            (12)
//   kNoResiduals         at the start: sum of w omega <= 0 (none, or all are outliers)      (13)
//   kNotFinite           at the start: F, g, H or q has a NaN or an infinity                (14)
//   kRefused             at the start: the problem is not defined                           (15)
//
// No allocation, no exceptions; only + - * / and sqrt in a fixed order, so the same calls of the
// problem give the same bits on every machine.
//
// Source: Madsen, Nielsen, Tingleff, Methods for Non-Linear Least Squares Problems, 2004.

#include <cassert>
#include <cmath>
#include <type_traits>

#include "flatpose/core/status.hpp"
#include "flatpose/refine/covariance.hpp"
#include "flatpose/refine/normal_equations.hpp"

namespace flatpose::refine {

struct LevenbergMarquardtConfig {
  int iteration_limit = 50;           ///< Trial steps, accepted or not. 1 to 100000.
  double gradient_tolerance = 1e-10;  ///< eps_g in (8), a cosine. 0 to 1; 0 is only exact.
  double step_tolerance = 1e-10;      ///< eps_h in (9). 0 to 1.
  double cost_tolerance = 1e-12;      ///< eps_F in (10). 0 to 1.
  double damping_start = 1e-3;        ///< mu at first. 1e-16 to damping_limit; more is shyer.
  double damping_limit = 1e16;        ///< mu_max in (11). Up to 1e30.
};

/// Fails: kInvalidArgument when a field is outside its range.
[[nodiscard]] inline Status validate(const LevenbergMarquardtConfig& config) noexcept {
  const auto is_share = [](double x) { return x >= 0.0 && x <= 1.0; };
  const bool ok = config.iteration_limit >= 1 && config.iteration_limit <= 100000 &&
                  is_share(config.gradient_tolerance) && is_share(config.step_tolerance) &&
                  is_share(config.cost_tolerance) && config.damping_start >= 1e-16 &&
                  config.damping_start <= config.damping_limit && config.damping_limit <= 1e30;
  return ok ? Status::kOk : Status::kInvalidArgument;
}

enum class Termination {
  kGradientTolerance,
  kStepTolerance,
  kCostTolerance,
  kIterationLimit,
  kDampingLimit,
  kNoResiduals,
  kNotFinite,
  kRefused,
};

/// A minimum was found, and not only a limit reached or nothing started.
[[nodiscard]] constexpr bool is_converged(Termination termination) noexcept {
  return termination == Termination::kGradientTolerance ||
         termination == Termination::kStepTolerance || termination == Termination::kCostTolerance;
}

template <int N, class State>
struct Minimum {
  State x;  ///< The start when nothing better was found.
  Termination termination = Termination::kRefused;
  int iteration_count = 0;   ///< Trial steps.
  int evaluation_count = 0;  ///< Calls of the problem.
  double cost_start = 0.0;
  double cost_end = 0.0;
  Vector<N> gradient = Vector<N>::Zero();  ///< At x, as all that follows.
  Matrix<N> hessian = Matrix<N>::Zero();   ///< J^T W J, in the tangent space of a manifold.
  double square_sum = 0.0;                 ///< sum of w omega r^2
  double weight_sum = 0.0;                 ///< sum of w omega
  int residual_count = 0;
};

/// The covariance of the parameters when residuals have the given variance (1 when the weights are
/// one over the variance already).  Fails: as covariance(hessian).
template <int N, class State>
[[nodiscard]] Result<Covariance<N>> covariance(const Minimum<N, State>& minimum,
                                               double variance = 1.0,
                                               double rank_tolerance = kRankTolerance) noexcept {
  return covariance<N>(minimum.hessian, variance, rank_tolerance);
}

namespace detail {

inline constexpr double kAcceptedGain = 1e-4;
inline constexpr double kDampingMin = 1e-16;  // below it mu no longer changes 1 + mu

template <int N>
class Damping {
 public:
  explicit Damping(double mu) noexcept : mu_(mu) { diagonal_.setZero(); }

  void see(const NormalEquations<N>& equations) noexcept {  // (2)
    for (int i = 0; i < N; ++i)
      if (equations.hessian(i, i) > diagonal_[i]) diagonal_[i] = equations.hessian(i, i);
  }
  void accept(double gain) noexcept {  // (6)
    const double bend = 2.0 * gain - 1.0;
    const double factor = 1.0 - bend * bend * bend;
    mu_ *= factor > 1.0 / 3.0 ? factor : 1.0 / 3.0;
    if (mu_ < kDampingMin) mu_ = kDampingMin;
    nu_ = 2.0;
  }
  void reject() noexcept {  // (7)
    mu_ *= nu_;
    nu_ *= 2.0;
  }
  [[nodiscard]] double mu() const noexcept { return mu_; }
  [[nodiscard]] double scale(int i) const noexcept {
    return diagonal_[i] > 0.0 ? 1.0 / std::sqrt(diagonal_[i]) : 1.0;
  }

 private:
  Vector<N> diagonal_;
  double mu_;
  double nu_ = 2.0;
};

/// Equations (3) and (4). False when rounding has made the system indefinite: damp more.
template <int N>
[[nodiscard]] bool damped_step(const NormalEquations<N>& equations, const Damping<N>& damping,
                               Vector<N>* step, double* promise) noexcept {
  Vector<N> scale, b, y;
  for (int i = 0; i < N; ++i) scale[i] = damping.scale(i);
  Matrix<N> a = Matrix<N>::Zero();
  for (int j = 0; j < N; ++j) {
    b[j] = -scale[j] * equations.gradient()[j];
    for (int i = j; i < N; ++i) a(i, j) = scale[i] * equations.hessian(i, j) * scale[j];
    a(j, j) += damping.mu();
  }
  if (!solve_positive_definite<N>(a, b, &y)) return false;
  for (int i = 0; i < N; ++i) (*step)[i] = scale[i] * y[i];
  *promise = 0.5 * (damping.mu() * dot<N>(y, y) + dot<N>(y, b));
  return is_finite<N>(*step) && std::isfinite(*promise);
}

template <int N>
[[nodiscard]] bool is_stationary(const NormalEquations<N>& equations, double tolerance) noexcept {
  for (int i = 0; i < N; ++i) {  // (8)
    const double length = std::sqrt(equations.hessian(i, i)) * std::sqrt(equations.square_sum());
    if (!(std::fabs(equations.gradient()[i]) <= tolerance * length)) return false;
  }
  return true;
}

template <int N, class State>
[[nodiscard]] bool is_small_step(const State& x, const Vector<N>& step, double tolerance) noexcept {
  for (int i = 0; i < N; ++i) {  // (9)
    double magnitude = 1.0;
    if constexpr (std::is_same_v<State, Vector<N>>) magnitude = std::fabs(x[i]);
    if (!(std::fabs(step[i]) <= tolerance * (magnitude + tolerance))) return false;
  }
  return true;
}

template <int N, class Problem, class State>
[[nodiscard]] State moved(const Problem& problem, const State& x, const Vector<N>& step) noexcept {
  if constexpr (requires { problem.plus(x, step); }) {
    return problem.plus(x, step);
  } else {
    return x + step;
  }
}

template <int N, class State>
[[nodiscard]] Minimum<N, State> ended(Minimum<N, State> out, const NormalEquations<N>& at_x,
                                      Termination termination) noexcept {
  out.termination = termination;
  out.cost_end = at_x.cost();
  out.gradient = at_x.gradient();
  out.hessian = at_x.hessian();
  out.square_sum = at_x.square_sum();
  out.weight_sum = at_x.weight_sum();
  out.residual_count = at_x.residual_count();
  return out;
}

}  // namespace detail

/// Finds the local minimum of the problem's cost that lies downhill of `start`.
///
/// `problem` has `bool evaluate(const State& x, NormalEquations<N>* equations) const noexcept`,
/// which adds every residual at x and returns false where there are none to be had, and, when State
/// is not Vector<N>, `State plus(const State& x, const Vector<N>& step) const noexcept`, x (+) h;
/// its rows are derivatives with respect to h at h = 0. Costs only compare when the same residuals
/// are added at every x: one that drops out must leave its cost behind.
///
/// Cost: one evaluation and about N^3 / 6 a trial step.  Memory: none, about 100 N^2 bytes of
/// stack.  Fails: never; see Minimum::termination.  Thread: reentrant.
template <int N, class Problem, class State>
[[nodiscard]] Minimum<N, State> minimize(const Problem& problem, const State& start,
                                         const LevenbergMarquardtConfig& config = {}) noexcept {
  assert(validate(config) == Status::kOk);
  Minimum<N, State> out{.x = start};
  NormalEquations<N> at_x;
  out.evaluation_count = 1;
  if (!problem.evaluate(start, &at_x)) return out;
  out.cost_start = at_x.cost();
  if (!at_x.is_finite()) return detail::ended<N>(out, at_x, Termination::kNotFinite);
  if (!(at_x.weight_sum() > 0.0)) return detail::ended<N>(out, at_x, Termination::kNoResiduals);

  detail::Damping<N> damping(config.damping_start);
  damping.see(at_x);
  if (detail::is_stationary<N>(at_x, config.gradient_tolerance))
    return detail::ended<N>(out, at_x, Termination::kGradientTolerance);

  NormalEquations<N> at_trial;
  while (out.iteration_count < config.iteration_limit) {  // (12)
    if (damping.mu() > config.damping_limit)
      return detail::ended<N>(out, at_x, Termination::kDampingLimit);  // (11)
    ++out.iteration_count;
    Vector<N> step;
    double promise = 0.0;
    if (!detail::damped_step<N>(at_x, damping, &step, &promise)) {
      damping.reject();
      continue;
    }
    if (detail::is_small_step<N>(out.x, step, config.step_tolerance))
      return detail::ended<N>(out, at_x, Termination::kStepTolerance);

    const State trial = detail::moved<N>(problem, out.x, step);
    at_trial.reset();
    ++out.evaluation_count;
    if (!problem.evaluate(trial, &at_trial) || !at_trial.is_finite() ||
        !(at_trial.weight_sum() > 0.0)) {
      damping.reject();
      continue;
    }
    const double decrease = at_x.cost() - at_trial.cost();
    const double flat = config.cost_tolerance * at_x.cost();
    const bool is_flat = std::fabs(decrease) <= flat && promise <= flat;  // (10)
    if (decrease > detail::kAcceptedGain * promise) {                     // (5)
      damping.accept(decrease / promise);
      out.x = trial;
      at_x = at_trial;
      damping.see(at_x);
      if (detail::is_stationary<N>(at_x, config.gradient_tolerance))
        return detail::ended<N>(out, at_x, Termination::kGradientTolerance);
    } else {
      damping.reject();
    }
    if (is_flat) return detail::ended<N>(out, at_x, Termination::kCostTolerance);
  }
  return detail::ended<N>(out, at_x, Termination::kIterationLimit);
}

}  // namespace flatpose::refine
