#pragma once
// Ceres as the outside judge of the solver. Its headers stay in one translation unit, for they take
// long to compile.

#include <functional>
#include <vector>

#include "flatpose/refine/robust_loss.hpp"

namespace flatpose::refine {

struct CeresTask {
  int residual_count = 0;
  std::vector<double> start;
  RobustLoss loss;
  /// Writes residual number k and its derivatives; false where it is not defined.
  std::function<bool(const double* parameters, int k, double* residual, double* row)> evaluate;
};

struct CeresOutcome {
  std::vector<double> x;
  double cost = 0.0;
  int iteration_count = 0;
};

CeresOutcome solve_with_ceres(const CeresTask& task);

}  // namespace flatpose::refine
