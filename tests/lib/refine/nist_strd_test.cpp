// The solver against certified results, and against Ceres on the same problems.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "flatpose/refine/levenberg_marquardt.hpp"
#include "tests/lib/refine/ceres_judge.hpp"
#include "tests/lib/refine/nist_strd_problems.hpp"

namespace flatpose::refine::nist {
namespace {

constexpr double kCertifiedDigits = 1e-10;  // 11 are printed

LevenbergMarquardtConfig tight_config() {
  LevenbergMarquardtConfig config;
  config.iteration_limit = 1000;
  config.gradient_tolerance = 1e-13;
  config.step_tolerance = 1e-13;
  config.cost_tolerance = 1e-15;
  return config;
}

template <int N>
struct Curve {
  const Problem* problem;

  bool evaluate(const Vector<N>& x, NormalEquations<N>* equations) const noexcept {
    for (const Observation& at : problem->observations) {
      const Prediction prediction = problem->predict(x.data(), at.x);
      equations->add(prediction.value - at.y, Vector<N>(prediction.derivative.data()));
    }
    return true;
  }
};

struct Outcome {
  Parameters x{};
  Parameters standard_deviation{};
  double residual_square_sum = 0.0;
  int iteration_count = 0;
  Termination termination{};
};

template <int N>
Outcome solve(const Problem& problem, const Parameters& start,
              const LevenbergMarquardtConfig& config) {
  const auto minimum = minimize<N>(Curve<N>{&problem}, Vector<N>(start.data()), config);
  const int freedom = minimum.residual_count - N;
  const auto spread = covariance(minimum, minimum.square_sum / freedom);
  Outcome out;
  for (int i = 0; i < N; ++i) {
    out.x[i] = minimum.x[i];
    out.standard_deviation[i] = spread->standard_deviation(i);
  }
  out.residual_square_sum = minimum.square_sum;
  out.iteration_count = minimum.iteration_count;
  out.termination = minimum.termination;
  return out;
}

Outcome solve(const Problem& problem, const Parameters& start,
              const LevenbergMarquardtConfig& config) {
  switch (problem.parameter_count) {
    case 2: return solve<2>(problem, start, config);
    case 3: return solve<3>(problem, start, config);
    case 4: return solve<4>(problem, start, config);
    case 5: return solve<5>(problem, start, config);
    case 6: return solve<6>(problem, start, config);
    default: return solve<7>(problem, start, config);
  }
}

/// Digits to which the worst parameter agrees.
double digits(const Problem& problem, const Parameters& x) {
  double worst = 16.0;
  for (int i = 0; i < problem.parameter_count; ++i)
    worst = std::min(worst, -std::log10(std::fabs(x[i] / problem.certified[i] - 1.0) + 1e-16));
  return worst;
}

Outcome solve_with_ceres(const Problem& problem, const Parameters& start) {
  CeresTask task;
  task.residual_count = static_cast<int>(problem.observations.size());
  task.start.assign(start.begin(), start.begin() + problem.parameter_count);
  task.evaluate = [&problem](const double* parameters, int k, double* residual, double* row) {
    const Observation& at = problem.observations[static_cast<std::size_t>(k)];
    const Prediction prediction = problem.predict(parameters, at.x);
    *residual = prediction.value - at.y;
    std::copy_n(prediction.derivative.begin(), problem.parameter_count, row);
    return std::isfinite(*residual);
  };
  const CeresOutcome theirs = refine::solve_with_ceres(task);
  Outcome out;
  std::copy(theirs.x.begin(), theirs.x.end(), out.x.begin());
  out.residual_square_sum = 2.0 * theirs.cost;
  out.iteration_count = theirs.iteration_count;
  return out;
}

class NistStrd : public testing::TestWithParam<Problem> {};

TEST_P(NistStrd, CertifiedParametersGiveTheCertifiedSum) {
  const Problem& problem = GetParam();
  double sum = 0.0;
  for (const Observation& at : problem.observations) {
    const double residual = problem.predict(problem.certified.data(), at.x).value - at.y;
    sum += residual * residual;
  }
  EXPECT_NEAR(sum / problem.residual_square_sum, 1.0, kCertifiedDigits);
}

TEST_P(NistStrd, ArrivesAtTheCertifiedMinimum) {
  const Problem& problem = GetParam();
  for (const int start : {0, 1}) {
    if (problem.digits[start] == 0) continue;
    const Outcome ours = solve(problem, problem.starts[start], tight_config());
    EXPECT_TRUE(is_converged(ours.termination)) << "start " << start + 1;
    EXPECT_GE(digits(problem, ours.x), problem.digits[start]) << "start " << start + 1;
    EXPECT_NEAR(ours.residual_square_sum / problem.residual_square_sum, 1.0, kCertifiedDigits);
    for (int i = 0; i < problem.parameter_count; ++i)
      EXPECT_NEAR(ours.standard_deviation[i] / problem.standard_deviation[i], 1.0, 1e-5)
          << "parameter " << i;
  }
}

TEST_P(NistStrd, ArrivesWhereCeresArrives) {
  const Problem& problem = GetParam();
  for (const int start : {0, 1}) {
    if (problem.digits[start] == 0) continue;
    const Outcome ours = solve(problem, problem.starts[start], tight_config());
    const Outcome theirs = solve_with_ceres(problem, problem.starts[start]);
    const std::string name = "start_" + std::to_string(start + 1);
    RecordProperty(name + "_iterations", ours.iteration_count);
    RecordProperty(name + "_iterations_ceres", theirs.iteration_count);
    RecordProperty(name + "_digits", std::to_string(digits(problem, ours.x)));
    RecordProperty(name + "_digits_ceres", std::to_string(digits(problem, theirs.x)));
    // Never above Ceres, which itself may stay in another minimum.
    EXPECT_LE(ours.residual_square_sum, theirs.residual_square_sum * (1.0 + 1e-9));
    if (digits(problem, theirs.x) < 4.0) continue;
    for (int i = 0; i < problem.parameter_count; ++i)
      EXPECT_NEAR(ours.x[i] / theirs.x[i], 1.0, 2e-6) << name << " parameter " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Problems, NistStrd,
                         testing::ValuesIn(problems().begin(), problems().end()),
                         [](const testing::TestParamInfo<Problem>& problem) {
                           return std::string(problem.param.name);
                         });

TEST(NistStrdBoxBod, ArrivesFromTheFarStartWhenDampedFromTheBeginning) {
  const auto all = problems();
  const auto box_bod =
      std::find_if(all.begin(), all.end(), [](auto& p) { return std::string(p.name) == "BoxBOD"; });
  ASSERT_NE(box_bod, all.end());
  LevenbergMarquardtConfig config = tight_config();
  config.damping_start = 100.0;
  EXPECT_GE(digits(*box_bod, solve(*box_bod, box_bod->starts[0], config).x), 6.0);
}

}  // namespace
}  // namespace flatpose::refine::nist
