#define EIGEN_RUNTIME_NO_MALLOC
#include "flatpose/refine/levenberg_marquardt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <new>
#include <vector>

#include "flatpose/geometry/pose.hpp"
#include "tests/lib/autodiff/dual_transcendental.hpp"
#include "tests/lib/autodiff/random_expression.hpp"
#include "tests/lib/refine/ceres_judge.hpp"

namespace {
int new_count = 0;
}  // namespace

// Every `new` of this program is counted. The block is ASan's as before, by way of malloc.
void* operator new(std::size_t size_bytes) {
  ++new_count;
  return std::malloc(size_bytes == 0 ? 1 : size_bytes);
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace flatpose::refine {
namespace {

using autodiff::Random;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A problem from a callable, so that each test shows its residuals; of one type, so that the
/// solver is compiled once.
template <int N>
struct ProblemOf {
  std::function<bool(const Vector<N>&, NormalEquations<N>*)> function;
  bool evaluate(const Vector<N>& x, NormalEquations<N>* equations) const noexcept {
    return function(x, equations);
  }
};
template <int N, class Function>
ProblemOf<N> problem_of(Function function) {
  return {function};
}

LevenbergMarquardtConfig without_tolerances() {
  LevenbergMarquardtConfig config;
  config.gradient_tolerance = config.step_tolerance = config.cost_tolerance = 0.0;
  config.iteration_limit = 1000;
  return config;
}

/// x^3 / 3 + x + 1 and x - 2: one minimum, residuals that do not vanish there.
const auto kCubic = problem_of<1>([](const Vector<1>& at, NormalEquations<1>* equations) {
  const auto x = autodiff::seed<1>(at[0], 0);
  equations->add(x * x * x / 3.0 + x + 1.0);
  equations->add(x - 2.0);
  return true;
});
double cubic_slope(double x) { return (x * x * x / 3 + x + 1) * (x * x + 1) + (x - 2); }

template <int N>
Vector<N> random_vector(Random& random, double limit = 1.0) {
  Vector<N> out;
  for (int i = 0; i < N; ++i) out[i] = random.uniform(-limit, limit);
  return out;
}

// --- the parts ---------------------------------------------------------------------------------

TEST(NormalEquations, SumsOfSparseRowsAreRowsWithZeros) {
  NormalEquations<6> full, summed;
  SparseSums<3> sums;
  const RobustLoss loss = RobustLoss::tukey(1.0);
  for (int k = 0; k < 20; ++k) {
    const double residual = 0.15 * k - 1.4, a = 0.3 * k, b = 2.0 - k, c = 0.7;
    Vector<6> row;
    row << a, b, 0.0, 0.0, 0.0, c;
    full.add(residual, row, 1.5, loss);
    const double weight = 1.5 * loss(residual).weight;
    sums.cost += 1.5 * loss(residual).cost;
    sums.square_sum += weight * residual * residual;
    sums.weight_sum += weight;
    ++sums.residual_count;
    const std::array derivatives{a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
      sums.gradient[i] += weight * residual * derivatives[i];
      for (std::size_t j = 0; j <= i; ++j)
        sums.hessian_lower[i][j] += weight * derivatives[i] * derivatives[j];
    }
  }
  summed.add_summed<0, 1, 5>(sums);
  const auto expect_equal = [](double x, double y) {
    EXPECT_NEAR(x, y, 1e-9 * (1.0 + std::fabs(x)));
  };
  expect_equal(full.cost(), summed.cost());
  expect_equal(full.square_sum(), summed.square_sum());
  expect_equal(full.weight_sum(), summed.weight_sum());
  EXPECT_EQ(full.residual_count(), summed.residual_count());
  for (int i = 0; i < 6; ++i) {
    expect_equal(full.gradient()[i], summed.gradient()[i]);
    for (int j = 0; j < 6; ++j) expect_equal(full.hessian(i, j), summed.hessian(i, j));
  }
}

TEST(NormalEquations, RejectedResidualsCostAndHoldNothing) {
  NormalEquations<2> told, seen;
  const RobustLoss loss = RobustLoss::tukey(0.5);
  told.add_rejected(3.0 * loss(1e3).cost);
  seen.add_lazily(
      7.0,
      []() -> Vector<2> {
        ADD_FAILURE() << "no row of a rejected residual is needed";
        return Vector<2>::Zero();
      },
      3.0, loss);
  EXPECT_EQ(told.cost(), seen.cost());
  EXPECT_EQ(told.residual_count(), 1);
  EXPECT_EQ(seen.residual_count(), 1);
  EXPECT_EQ(seen.weight_sum(), 0.0);
  EXPECT_TRUE(seen.is_finite());
  seen.add(std::numeric_limits<double>::infinity(), Vector<2>::Zero(), 1.0, loss);
  EXPECT_FALSE(seen.is_finite());
}

TEST(RobustLoss, WeightIsTheSlopeOfTheCostOverTheResidual) {
  for (const RobustLoss loss : {RobustLoss{}, RobustLoss::huber(0.7), RobustLoss::tukey(1.3)}) {
    for (double r = -2.003; r < 2.0; r += 0.01) {
      const double step = 1e-6;
      const double slope = (loss(r + step).cost - loss(r - step).cost) / (2 * step);
      ASSERT_NEAR(loss(r).weight * r, slope, 1e-8) << r;
    }
    EXPECT_EQ(loss(0.0).cost, 0.0);
    EXPECT_EQ(loss(0.0).weight, 1.0);
    EXPECT_NEAR(loss(1e-5).cost, 0.5e-10, 1e-19);
  }
}

template <int N>
void expect_solution_and_decomposition(Random& random) {
  Matrix<N> m;
  for (int i = 0; i < N * N; ++i) m.data()[i] = random.uniform(-1, 1);
  const Matrix<N> a = m * m.transpose() + 0.01 * Matrix<N>::Identity();
  const Vector<N> b = random_vector<N>(random);
  Vector<N> x;
  ASSERT_TRUE(solve_positive_definite<N>(a, b, &x));
  EXPECT_LT((a * x - b).norm(), 1e-12 * (1.0 + x.norm()));

  const Eigenvalues<N> eigen = symmetric_eigenvalues<N>(a);
  EXPECT_LT((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - a).norm(),
            1e-13 * (1.0 + a.norm()));
  EXPECT_LT((eigen.vectors * eigen.vectors.transpose() - Matrix<N>::Identity()).norm(), 1e-13);
}

TEST(SmallMatrix, SolvesAndDecomposes) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    expect_solution_and_decomposition<1>(random);
    expect_solution_and_decomposition<2>(random);
    expect_solution_and_decomposition<6>(random);
    expect_solution_and_decomposition<7>(random);
  }
}

TEST(SmallMatrix, RefusesWhatIsNotPositiveDefinite) {
  Vector<2> x;
  const Matrix<2> singular{{1.0, 1.0}, {1.0, 1.0}};
  const Matrix<2> indefinite{{1.0, 2.0}, {2.0, 1.0}};
  EXPECT_FALSE(solve_positive_definite<2>(singular, Vector<2>(1, 1), &x));
  EXPECT_FALSE(solve_positive_definite<2>(indefinite, Vector<2>(1, 1), &x));
  EXPECT_FALSE(solve_positive_definite<2>(kNan * singular, Vector<2>(1, 1), &x));
  EXPECT_FALSE(solve_positive_definite<2>(Matrix<2>::Identity(), Vector<2>(1, kNan), &x));
}

TEST(NormalEquations, EqualTheProductsOfTheStackedJacobian) {
  Random random(2);
  constexpr int kRows = 40;
  Eigen::Matrix<double, kRows, 4> jacobian;
  Eigen::Matrix<double, kRows, 1> residual, weight;
  NormalEquations<4> equations;
  double cost = 0.0;
  for (int k = 0; k < kRows; ++k) {
    const RobustLoss loss = k % 2 == 0 ? RobustLoss::huber(0.5) : RobustLoss::tukey(0.9);
    const double r = random.uniform(-2, 2), w = random.uniform(0, 3);
    const Vector<4> row = random_vector<4>(random);
    equations.add(r, row, w, loss);
    jacobian.row(k) = row.transpose();
    residual[k] = r;
    weight[k] = w * loss(r).weight;
    cost += w * loss(r).cost;
  }
  const Matrix<4> hessian = jacobian.transpose() * weight.asDiagonal() * jacobian;
  const Vector<4> gradient = jacobian.transpose() * weight.asDiagonal() * residual;
  EXPECT_LT((equations.hessian() - hessian).norm(), 1e-12);
  EXPECT_LT((equations.gradient() - gradient).norm(), 1e-12);
  EXPECT_NEAR(equations.cost(), cost, 1e-12);
  EXPECT_NEAR(equations.square_sum(), residual.dot(weight.asDiagonal() * residual), 1e-12);
  EXPECT_NEAR(equations.weight_sum(), weight.sum(), 1e-12);
  EXPECT_EQ(equations.residual_count(), kRows);
}

TEST(NormalEquations, TakeAPriorIntoTheSumsButNotIntoTheCount) {
  NormalEquations<2> equations;
  equations.add_prior(1, -3.0, 2.0);
  EXPECT_EQ(equations.cost(), 9.0);
  EXPECT_EQ(equations.gradient(), Vector<2>(0.0, -6.0));
  EXPECT_EQ(equations.hessian(), (Matrix<2>{{0.0, 0.0}, {0.0, 2.0}}));
  EXPECT_EQ(equations.square_sum(), 18.0);
  EXPECT_EQ(equations.weight_sum(), 0.0);
  EXPECT_EQ(equations.residual_count(), 0);
}

TEST(NormalEquations, NoticeWhatIsNotFiniteEvenUnderALossThatLevelsOff) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (const RobustLoss loss : {RobustLoss{}, RobustLoss::huber(1), RobustLoss::tukey(1)}) {
      NormalEquations<2> residual, row, weight;
      residual.add(bad, Vector<2>(1, 1), 1.0, loss);
      row.add(5.0, Vector<2>(1, bad), 1.0, loss);
      EXPECT_FALSE(residual.is_finite());
      EXPECT_FALSE(row.is_finite());
      if (bad < 0.0) continue;
      weight.add(0.5, Vector<2>(1, 1), bad, loss);
      EXPECT_FALSE(weight.is_finite());
    }
  }
}

// --- each way to end ---------------------------------------------------------------------------

TEST(Termination, GradientTolerance) {
  auto config = without_tolerances();
  config.gradient_tolerance = 1e-6;
  const auto minimum = minimize<1>(kCubic, Vector<1>(5.0), config);
  EXPECT_EQ(minimum.termination, Termination::kGradientTolerance);
  EXPECT_LE(std::fabs(minimum.gradient[0]),
            1e-6 * std::sqrt(minimum.hessian(0, 0) * minimum.square_sum));
  EXPECT_NEAR(cubic_slope(minimum.x[0]), minimum.gradient[0], 1e-12);
  EXPECT_TRUE(is_converged(minimum.termination));
}

TEST(Termination, GradientToleranceAtOnceAtAPerfectStart) {
  const auto problem = problem_of<1>([](const Vector<1>& x, NormalEquations<1>* equations) {
    equations->add(autodiff::seed<1>(x[0], 0) - 3.0);
    return true;
  });
  const auto minimum = minimize<1>(problem, Vector<1>(3.0), without_tolerances());
  EXPECT_EQ(minimum.termination, Termination::kGradientTolerance);
  EXPECT_EQ(minimum.iteration_count, 0);
  EXPECT_EQ(minimum.evaluation_count, 1);
  EXPECT_EQ(minimum.cost_end, 0.0);
}

TEST(Termination, StepTolerance) {
  auto config = without_tolerances();
  config.step_tolerance = 1e-7;
  const auto minimum = minimize<1>(kCubic, Vector<1>(5.0), config);
  EXPECT_EQ(minimum.termination, Termination::kStepTolerance);
  EXPECT_NEAR(cubic_slope(minimum.x[0]), 0.0, 1e-5);
  EXPECT_TRUE(is_converged(minimum.termination));
}

TEST(Termination, CostTolerance) {
  auto config = without_tolerances();
  config.cost_tolerance = 1e-9;
  const auto minimum = minimize<1>(kCubic, Vector<1>(5.0), config);
  EXPECT_EQ(minimum.termination, Termination::kCostTolerance);
  EXPECT_NEAR(cubic_slope(minimum.x[0]), 0.0, 1e-3);
  EXPECT_LT(minimum.cost_end, minimum.cost_start);
  EXPECT_TRUE(is_converged(minimum.termination));
}

TEST(Termination, IterationLimit) {
  auto config = without_tolerances();
  for (const int limit : {1, 2, 3}) {
    config.iteration_limit = limit;
    const auto minimum = minimize<1>(kCubic, Vector<1>(50.0), config);
    EXPECT_EQ(minimum.termination, Termination::kIterationLimit);
    EXPECT_EQ(minimum.iteration_count, limit);
    EXPECT_LE(minimum.evaluation_count, limit + 1);
    EXPECT_LT(minimum.cost_end, minimum.cost_start) << "the best so far is kept";
  }
}

TEST(Termination, DampingLimitWhenTheDerivativesAreWrong) {
  const auto problem = problem_of<1>([](const Vector<1>& x, NormalEquations<1>* equations) {
    equations->add(x[0] - 3.0, Vector<1>(-1.0));
    return true;
  });
  auto config = without_tolerances();
  config.damping_limit = 1e6;
  const auto minimum = minimize<1>(problem, Vector<1>(1.0), config);
  EXPECT_EQ(minimum.termination, Termination::kDampingLimit);
  EXPECT_EQ(minimum.x[0], 1.0);
  EXPECT_EQ(minimum.cost_end, minimum.cost_start);
  EXPECT_FALSE(is_converged(minimum.termination));
}

TEST(Termination, NoResidualsWhenNoneIsAddedOrAllAreOutliers) {
  const auto none = problem_of<2>([](const Vector<2>&, NormalEquations<2>*) { return true; });
  const auto outliers = problem_of<2>([](const Vector<2>& x, NormalEquations<2>* equations) {
    equations->add(x[0] - 9.0, Vector<2>(1.0, 0.0), 1.0, RobustLoss::tukey(1.0));
    return true;
  });
  const auto prior_alone = problem_of<2>([](const Vector<2>& x, NormalEquations<2>* equations) {
    equations->add_prior(0, x[0] - 1.0, 1.0);
    return true;
  });
  const Vector<2> start(1.0, 2.0);
  EXPECT_EQ(minimize<2>(none, start).termination, Termination::kNoResiduals);
  EXPECT_EQ(minimize<2>(outliers, start).termination, Termination::kNoResiduals);
  EXPECT_EQ(minimize<2>(prior_alone, start).termination, Termination::kNoResiduals);
  EXPECT_EQ(minimize<2>(outliers, start).residual_count, 1);
  EXPECT_EQ(minimize<2>(none, start).x, start);
  EXPECT_FALSE(is_converged(Termination::kNoResiduals));
}

TEST(Termination, NotFiniteAtTheStart) {
  for (const double bad : {kNan, kInfinity}) {
    const auto problem = problem_of<1>([bad](const Vector<1>& x, NormalEquations<1>* equations) {
      equations->add(x[0], Vector<1>(1.0));
      equations->add(bad, Vector<1>(1.0));
      return true;
    });
    const auto minimum = minimize<1>(problem, Vector<1>(1.0));
    EXPECT_EQ(minimum.termination, Termination::kNotFinite);
    EXPECT_EQ(minimum.evaluation_count, 1);
    EXPECT_EQ(minimum.x[0], 1.0);
  }
  EXPECT_EQ(minimize<1>(kCubic, Vector<1>(kNan)).termination, Termination::kNotFinite);
  EXPECT_EQ(minimize<1>(kCubic, Vector<1>(1e200)).termination, Termination::kNotFinite);
  EXPECT_FALSE(is_converged(Termination::kNotFinite));
}

TEST(Termination, RefusedAtTheStart) {
  const auto problem = problem_of<1>([](const Vector<1>&, NormalEquations<1>*) { return false; });
  const auto minimum = minimize<1>(problem, Vector<1>(1.0));
  EXPECT_EQ(minimum.termination, Termination::kRefused);
  EXPECT_EQ(minimum.x[0], 1.0);
  EXPECT_FALSE(is_converged(minimum.termination));
}

// --- trials that go wrong ----------------------------------------------------------------------

TEST(Minimize, RejectsATrialThatIsNotFiniteAndGoesOn) {
  int nan_count = 0;
  const auto problem =
      problem_of<1>([&nan_count](const Vector<1>& x, NormalEquations<1>* equations) {
        nan_count += std::isnan(std::sqrt(x[0]));
        equations->add(sqrt(autodiff::seed<1>(x[0], 0)) - 0.1);  // Newton's step goes below 0
        return true;
      });
  const auto minimum = minimize<1>(problem, Vector<1>(4.0));
  EXPECT_GT(nan_count, 0);
  EXPECT_TRUE(is_converged(minimum.termination));
  EXPECT_NEAR(minimum.x[0], 0.01, 1e-9);
}

TEST(Minimize, RejectsATrialOfLowerCostWhoseDerivativesAreNotFinite) {
  const auto problem = problem_of<1>([](const Vector<1>& x, NormalEquations<1>* equations) {
    equations->add(x[0] - 1.0, Vector<1>(x[0] < 1.5 ? kInfinity : 1.0));
    return true;
  });
  const auto minimum = minimize<1>(problem, Vector<1>(4.0));
  EXPECT_GE(minimum.x[0], 1.5);
  EXPECT_TRUE(std::isfinite(minimum.hessian(0, 0)));
}

TEST(Minimize, RejectsATrialThatTheProblemRefusesOrLeavesEmpty) {
  for (const bool refuses : {true, false}) {
    int hit_count = 0;
    const auto problem = problem_of<1>([&](const Vector<1>& x, NormalEquations<1>* equations) {
      if (x[0] < 0.0) {
        ++hit_count;
        return !refuses;
      }
      equations->add(sqrt(autodiff::seed<1>(x[0], 0)) - 0.1);
      return true;
    });
    const auto minimum = minimize<1>(problem, Vector<1>(4.0));
    EXPECT_GT(hit_count, 0);
    EXPECT_NEAR(minimum.x[0], 0.01, 1e-9);
  }
}

TEST(Minimize, NeverRaisesTheCost) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Vector<3> c = random_vector<3>(random, 3.0), start = random_vector<3>(random, 3.0);
    const auto problem = problem_of<3>([&c](const Vector<3>& at, NormalEquations<3>* equations) {
      const auto x = autodiff::seed<3>(at[0], 0), y = autodiff::seed<3>(at[1], 1),
                 z = autodiff::seed<3>(at[2], 2);
      equations->add(sin(x * y) - c[0]);
      equations->add(x * x + z - c[1], 1.0, RobustLoss::huber(0.5));
      equations->add(cos(z) * y - c[2], 2.0, RobustLoss::tukey(2.0));
      return true;
    });
    const auto minimum = minimize<3>(problem, start);
    ASSERT_LE(minimum.cost_end, minimum.cost_start);
    NormalEquations<3> again;
    ASSERT_TRUE(problem.evaluate(minimum.x, &again));
    ASSERT_EQ(again.cost(), minimum.cost_end);
    ASSERT_EQ(again.hessian(), minimum.hessian);
  }
}

// --- what it finds -----------------------------------------------------------------------------

TEST(Minimize, FindsThePriorsMeanOfADirectionThatTheResidualsLeaveFree) {
  // Only x + y is measured; a prior holds y. The posterior mean is known in closed form.
  const double information = 4.0;
  const auto problem = problem_of<2>([=](const Vector<2>& at, NormalEquations<2>* equations) {
    equations->add(at[0] + at[1] - 5.0, Vector<2>(1.0, 1.0), 3.0);
    equations->add_prior(1, at[1] - 2.0, information);
    return true;
  });
  const auto minimum = minimize<2>(problem, Vector<2>(0.0, 0.0));
  EXPECT_NEAR(minimum.x[0], 3.0, 1e-9);
  EXPECT_NEAR(minimum.x[1], 2.0, 1e-9);
  EXPECT_EQ(minimum.residual_count, 1);
  EXPECT_EQ(minimum.weight_sum, 3.0);
  const auto spread = covariance(minimum);
  ASSERT_TRUE(spread);
  EXPECT_TRUE(spread->is_full_rank());
  EXPECT_NEAR(spread->matrix(1, 1), 1.0 / information, 1e-12);
  EXPECT_NEAR(spread->matrix(0, 0), 1.0 / 3.0 + 1.0 / information, 1e-12);
}

struct RotationProblem {
  std::vector<Vec3> from, to;

  bool evaluate(const Rotation& turn, NormalEquations<3>* equations) const noexcept {
    for (std::size_t k = 0; k < from.size(); ++k) {
      // d/dh exp(h) p at h = 0 is h x p.
      const Vec3 p = turn * from[k];
      equations->add(p.x - to[k].x, Vector<3>(0.0, p.z, -p.y));
      equations->add(p.y - to[k].y, Vector<3>(-p.z, 0.0, p.x));
      equations->add(p.z - to[k].z, Vector<3>(p.y, -p.x, 0.0));
    }
    return true;
  }
  static Rotation plus(const Rotation& turn, const Vector<3>& step) noexcept {
    return orthonormalized(rotation_from_vector({step[0], step[1], step[2]}) * turn);
  }
};

TEST(Minimize, FindsOnTheManifoldOfRotationsThePolarFactor) {
  Random random(4);
  for (int k = 0; k < 50; ++k) {
    RotationProblem problem;
    const Vector<3> v = random_vector<3>(random, 1.2);
    const Rotation truth = rotation_from_vector({v[0], v[1], v[2]});
    Matrix<3> products = Matrix<3>::Zero();
    for (int i = 0; i < 12; ++i) {
      const Vector<3> p = random_vector<3>(random, 10.0), noise = random_vector<3>(random, 0.5);
      problem.from.push_back({p[0], p[1], p[2]});
      problem.to.push_back(truth * problem.from.back() + Vec3{noise[0], noise[1], noise[2]});
      const Vec3& to = problem.to.back();
      products += Vector<3>(to.x, to.y, to.z) * p.transpose();
    }
    const auto minimum = minimize<3>(problem, Rotation{});
    ASSERT_TRUE(is_converged(minimum.termination));
    // The best turn is the orthogonal factor of the sum of to from^T: what is left after it is
    // symmetric and positive definite, and no other turn does that (Horn 1988).
    const Matrix<3> best = Eigen::Map<const Matrix<3>>(minimum.x.m.data());  // transposed
    const Matrix<3> left = best * products;
    EXPECT_LT((left - left.transpose()).norm(), 1e-6 * left.norm()) << k;
    Vector<3> unused;
    EXPECT_TRUE(solve_positive_definite<3>(left, Vector<3>::Zero(), &unused)) << k;
  }
}

struct Decay {  // y = height exp(-rate x) + floor, with outliers
  static constexpr int kCount = 60;
  double x[kCount], y[kCount];
  RobustLoss loss;

  Decay(Random& random, const Vector<3>& truth) {
    for (int k = 0; k < kCount; ++k) {
      x[k] = 0.1 * k;
      y[k] = truth[0] * std::exp(-truth[1] * x[k]) + truth[2] + random.uniform(-0.05, 0.05);
      if (random.below(6) == 0) y[k] += random.uniform(-3.0, 3.0);
    }
  }
  [[nodiscard]] autodiff::Dual<3> residual(const double* p, int k) const noexcept {
    using autodiff::seed;
    return seed<3>(p[0], 0) * exp(-seed<3>(p[1], 1) * x[k]) + seed<3>(p[2], 2) - y[k];
  }
  bool evaluate(const Vector<3>& p, NormalEquations<3>* equations) const noexcept {
    for (int k = 0; k < kCount; ++k) equations->add(residual(p.data(), k), 1.0, loss);
    return true;
  }
};

CeresOutcome solve_with_ceres(const Decay& decay, const Vector<3>& start) {
  CeresTask task{Decay::kCount, {start[0], start[1], start[2]}, decay.loss, {}};
  task.evaluate = [&decay](const double* p, int k, double* residual, double* row) {
    const autodiff::Dual<3> at = decay.residual(p, k);
    *residual = at.value;
    std::copy(at.derivative.begin(), at.derivative.end(), row);
    return true;
  };
  return refine::solve_with_ceres(task);
}

TEST(Minimize, FindsTheMinimumOfCeresOnRandomRobustProblems) {
  Random random(5);
  int iteration_count = 0, iteration_count_ceres = 0;
  auto config = LevenbergMarquardtConfig{};
  config.iteration_limit = 500;
  config.cost_tolerance = 1e-15;
  for (int k = 0; k < 40; ++k) {
    const Vector<3> truth(random.uniform(2, 5), random.uniform(0.3, 2), random.uniform(-1, 1));
    Decay decay(random, truth);
    Vector<3> start = truth + random_vector<3>(random, 0.25);
    for (const RobustLoss loss : {RobustLoss::huber(0.1), RobustLoss::tukey(0.5)}) {
      decay.loss = loss;
      const auto ours = minimize<3>(decay, start, config);
      const CeresOutcome ceres = solve_with_ceres(decay, start);
      const Vector<3> theirs(ceres.x.data());
      iteration_count += ours.iteration_count;
      iteration_count_ceres += ceres.iteration_count;
      ASSERT_TRUE(is_converged(ours.termination)) << k;
      EXPECT_NEAR(ours.cost_end, ceres.cost, 1e-9 * ceres.cost) << k;
      EXPECT_LT((ours.x - theirs).norm(), 1e-6 * theirs.norm()) << k;
      EXPECT_LT((ours.x - truth).norm(), 0.3) << k;
      EXPECT_LT(ours.weight_sum, ours.residual_count);
      start = ours.x + random_vector<3>(random, 0.02);  // Tukey's loss has many minima
    }
  }
  RecordProperty("iterations", iteration_count);
  RecordProperty("iterations_ceres", iteration_count_ceres);
}

// --- the covariance ----------------------------------------------------------------------------

TEST(Covariance, OfALineEqualsTheFormula) {
  // y = a + b x, variance s^2: var(b) = s^2 / Sxx, var(a) = s^2 (1/n + mean^2 / Sxx).
  const double variance = 0.09;
  double mean = 0.0, sxx = 0.0;
  constexpr int kCount = 11;
  for (int k = 0; k < kCount; ++k) mean += (k * k) / static_cast<double>(kCount);
  for (int k = 0; k < kCount; ++k) sxx += (k * k - mean) * (k * k - mean);
  const auto line = problem_of<2>([](const Vector<2>& at, NormalEquations<2>* equations) {
    for (int k = 0; k < kCount; ++k)
      equations->add(at[0] + at[1] * k * k - std::sin(k), Vector<2>(1.0, k * k));
    return true;
  });
  const auto minimum = minimize<2>(line, Vector<2>(0.0, 0.0));
  const auto spread = covariance(minimum, variance);
  ASSERT_TRUE(spread);
  EXPECT_TRUE(spread->is_full_rank());
  EXPECT_TRUE(spread->is_held(0) && spread->is_held(1));
  EXPECT_NEAR(spread->matrix(1, 1), variance / sxx, 1e-12 * variance / sxx);
  EXPECT_NEAR(spread->matrix(0, 0), variance * (1.0 / kCount + mean * mean / sxx), 1e-12);
  EXPECT_NEAR(spread->matrix(0, 1), -variance * mean / sxx, 1e-12);
  EXPECT_EQ(spread->standard_deviation(0), std::sqrt(spread->matrix(0, 0)));
}

TEST(Covariance, IsTheInverseInWhateverUnits) {
  Random random(6);
  for (int k = 0; k < 200; ++k) {
    NormalEquations<6> equations;
    for (int row = 0; row < 12; ++row) {
      Vector<6> derivatives = random_vector<6>(random);
      for (int i = 0; i < 6; ++i) derivatives[i] *= std::pow(10.0, 3 * i - 7);  // mm beside rad
      equations.add(1.0, derivatives);
    }
    const Matrix<6> hessian = equations.hessian();
    const auto spread = covariance<6>(hessian, 2.0);
    ASSERT_TRUE(spread && spread->is_full_rank());
    Matrix<6> tame, spread_tame;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) {
        const double unit = std::pow(10.0, 3 * (i + j) - 14);
        tame(i, j) = hessian(i, j) / unit;
        spread_tame(i, j) = spread->matrix(i, j) * unit;
      }
    }
    ASSERT_LT((tame * spread_tame - 2.0 * Matrix<6>::Identity()).norm(), 1e-9) << k;
  }
}

TEST(Covariance, ReportsTheFreeDirectionOfARankDeficientJacobian) {
  // Only 2 x + y and z are measured; along (1, -2, 0) nothing changes.
  const auto problem = problem_of<3>([](const Vector<3>& at, NormalEquations<3>* equations) {
    equations->add(2.0 * at[0] + at[1] - 7.0, Vector<3>(2.0, 1.0, 0.0));
    equations->add(at[2] - 1.0, Vector<3>(0.0, 0.0, 10.0));
    return true;
  });
  const auto minimum = minimize<3>(problem, Vector<3>(1.0, 1.0, 1.0));
  EXPECT_TRUE(is_converged(minimum.termination));
  EXPECT_NEAR(2.0 * minimum.x[0] + minimum.x[1], 7.0, 1e-9);
  const auto spread = covariance(minimum);
  ASSERT_TRUE(spread);
  EXPECT_EQ(spread->rank, 2);
  const Vector<3> free = spread->free_directions.col(0);
  EXPECT_NEAR(std::fabs(free[0]), 1.0 / std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(free[1], -2.0 * free[0], 1e-9);
  EXPECT_NEAR(free[2], 0.0, 1e-9);
  EXPECT_FALSE(spread->is_held(0));
  EXPECT_FALSE(spread->is_held(1));
  EXPECT_TRUE(spread->is_held(2));
  EXPECT_NEAR(spread->matrix(2, 2), 0.01, 1e-12);
}

TEST(Covariance, LeavesAParameterFreeThatNoResidualDependsOn) {
  const auto problem = problem_of<2>([](const Vector<2>& at, NormalEquations<2>* equations) {
    equations->add(at[0] - 7.0, Vector<2>(2.0, 0.0));
    return true;
  });
  const auto minimum = minimize<2>(problem, Vector<2>(1.0, 42.0));
  EXPECT_EQ(minimum.x[1], 42.0) << "what is free stays where it was";
  const auto spread = covariance(minimum);
  ASSERT_TRUE(spread);
  EXPECT_EQ(spread->rank, 1);
  EXPECT_TRUE(spread->is_held(0));
  EXPECT_FALSE(spread->is_held(1));
  EXPECT_EQ(spread->matrix(0, 0), 0.25);
  EXPECT_EQ(covariance<2>(Matrix<2>::Zero())->rank, 0);
}

TEST(Covariance, SharesOfSeveralFreeDirectionsAddUpToTheirCount) {
  NormalEquations<3> equations;
  equations.add(1.0, Vector<3>(2.0, -1.0, 3.0));
  const auto spread = covariance<3>(equations.hessian());
  ASSERT_TRUE(spread);
  EXPECT_EQ(spread->rank, 1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(spread->free_share[i], 2.0 / 3.0, 1e-12);
  const Vector<3> moved =
      equations.hessian() * spread->free_directions.leftCols<2>().rowwise().sum();
  EXPECT_LT(moved.norm(), 1e-12);
}

TEST(Covariance, RefusesWhatIsNoHessianOrNoVariance) {
  const Matrix<2> identity = Matrix<2>::Identity();
  EXPECT_EQ(covariance<2>(identity, -1.0).status(), Status::kInvalidArgument);
  EXPECT_EQ(covariance<2>(identity, 1.0, kNan).status(), Status::kInvalidArgument);
  EXPECT_EQ(covariance<2>(identity, kNan).status(), Status::kNotFinite);
  EXPECT_EQ(covariance<2>(-identity).status(), Status::kInvalidArgument);
  EXPECT_EQ(covariance<2>(kNan * identity).status(), Status::kNotFinite);
  EXPECT_EQ(covariance<2>(kInfinity * identity).status(), Status::kNotFinite);
}

// --- what it promises --------------------------------------------------------------------------

TEST(LevenbergMarquardtConfig, IsValidatedFieldByField) {
  EXPECT_EQ(validate({}), Status::kOk);
  const auto refused = [](auto change) {
    LevenbergMarquardtConfig config;
    change(config);
    return validate(config) == Status::kInvalidArgument;
  };
  EXPECT_TRUE(refused([](auto& c) { c.iteration_limit = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.iteration_limit = 100001; }));
  EXPECT_TRUE(refused([](auto& c) { c.gradient_tolerance = -1e-9; }));
  EXPECT_TRUE(refused([](auto& c) { c.step_tolerance = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.cost_tolerance = 2.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.damping_start = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.damping_limit = 1e-4; }));
  EXPECT_TRUE(refused([](auto& c) { c.damping_limit = kInfinity; }));
}

/// A rational curve: no libm, so that nothing but the solver decides on the bits.
const auto kRational = problem_of<3>([](const Vector<3>& at, NormalEquations<3>* equations) {
  const auto a = autodiff::seed<3>(at[0], 0), b = autodiff::seed<3>(at[1], 1),
             c = autodiff::seed<3>(at[2], 2);
  for (int k = 0; k < 20; ++k) {
    const double y = 1.5 + (2.0 + 0.5 * k) / (1.0 + 0.3 * k) + ((k * 37) % 11 - 5) / 40.0;
    equations->add((a + b * k) / (1.0 + c * c * k) + sqrt(1.0 + a * a) - y, 1.0 / (1 + k),
                   RobustLoss::huber(0.5));
  }
  return true;
});

TEST(Minimize, GivesTheSameBitsOnEveryMachine) {
  const auto minimum = minimize<3>(kRational, Vector<3>(1.0, 1.0, 1.0));
  const auto spread = covariance(minimum);
  ASSERT_TRUE(is_converged(minimum.termination) && spread);
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a over 64-bit words
  const auto mix = [&hash](double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211u;
  };
  for (int i = 0; i < 3; ++i) mix(minimum.x[i]);
  for (int i = 0; i < 9; ++i) mix(spread->matrix.data()[i]);
  EXPECT_EQ(hash, 2281365164735228806u);
}

TEST(Minimize, AllocatesNothing) {
  Eigen::internal::set_is_malloc_allowed(false);
  const int before = new_count;
  const auto minimum = minimize<3>(kRational, Vector<3>(1.0, 1.0, 1.0));
  const auto spread = covariance(minimum);
  const int after = new_count;
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(after, before);
  EXPECT_TRUE(spread);
}

TEST(Minimize, WouldBeCaughtAllocating) {
  const int before = new_count;
  const std::vector<double> block(100);
  EXPECT_EQ(new_count, before + 1) << block.size();
}

}  // namespace
}  // namespace flatpose::refine
