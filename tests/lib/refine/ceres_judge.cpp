#include "tests/lib/refine/ceres_judge.hpp"

#include <ceres/ceres.h>

namespace flatpose::refine {
namespace {

class CeresResidual final : public ceres::CostFunction {
 public:
  CeresResidual(const CeresTask& task, int k) : task_(task), k_(k), unused_row_(task.start.size()) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(task.start.size()));
  }
  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override {
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    return task_.evaluate(parameters[0], k_, residual, wanted ? jacobians[0] : unused_row_.data());
  }

 private:
  const CeresTask& task_;
  int k_;
  mutable std::vector<double> unused_row_;  // Ceres runs here on one thread
};

ceres::LossFunction* loss_function(const RobustLoss& loss) {
  if (loss.kind == LossKind::kHuber) return new ceres::HuberLoss(loss.scale);
  if (loss.kind == LossKind::kTukey) return new ceres::TukeyLoss(loss.scale);
  return nullptr;
}

}  // namespace

CeresOutcome solve_with_ceres(const CeresTask& task) {
  CeresOutcome out{task.start, 0.0, 0};
  ceres::Problem problem;
  for (int k = 0; k < task.residual_count; ++k)
    problem.AddResidualBlock(new CeresResidual(task, k), loss_function(task.loss), out.x.data());
  ceres::Solver::Options options;
  options.max_num_iterations = 10000;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-16;
  options.gradient_tolerance = 1e-18;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  out.cost = summary.final_cost;
  out.iteration_count = static_cast<int>(summary.iterations.size()) - 1;
  return out;
}

}  // namespace flatpose::refine
