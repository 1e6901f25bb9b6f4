#include "flatpose/locate/refinement.hpp"

namespace flatpose::locate {
namespace {

// What one ends with the next one, or the polish on raw points, goes on from: fractions of a cell.
refine::LevenbergMarquardtConfig solver_config(int iteration_limit) noexcept {
  refine::LevenbergMarquardtConfig config;
  config.iteration_limit = iteration_limit;
  config.step_tolerance = 1e-3;
  config.cost_tolerance = 1e-3;
  return config;
}

}  // namespace

Refined Refinement::operator()(const Pose& start) const noexcept {
  Refined out;
  if (verifier_.verify(images_, {}, start, settings_.screen).score < settings_.screen.least_score)
    return out;
  out.is_moved = true;
  const refine::PoseProblem wide(part_, images_, settings_.wide);
  const Pose near = refine::minimize<6>(wide, start, solver_config(10)).x;
  out.work_T_object = near;
  if (verifier_.verify(images_, {}, near, settings_.near).score < settings_.near.least_score)
    return out;
  const refine::PoseProblem narrow(part_, images_, settings_.narrow);
  out.work_T_object = refine::minimize<6>(narrow, near, solver_config(15)).x;
  out.verification = verifier_.verify(images_, {}, out.work_T_object, settings_.verify);
  out.is_found = true;
  return out;
}

}  // namespace flatpose::locate
