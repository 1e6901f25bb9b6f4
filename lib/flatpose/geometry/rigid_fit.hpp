#pragma once
// The rigid transform that lays points onto their partners with the least sum of squared distances
// (Horn 1987, closed form by quaternions).
//
//   S = sum (from - middle of from) (to - middle of to)^T           a 3 x 3 matrix
//   N = a symmetric 4 x 4 matrix of S's sums and differences        (Horn, equation 8)
//   q = N's eigenvector of the largest eigenvalue                   by Jacobi's turns
//
// Points in one plane are enough; on one line the turn about it stays open.

#include <span>

#include "flatpose/core/result.hpp"
#include "flatpose/geometry/pose.hpp"

namespace flatpose {

struct RigidFit {
  Pose to_T_from;
  double rms_mm = 0.0;  ///< Of the distances left.
  /// How widely `from` is spread about its middle (root of the mean square), along its widest
  /// direction, across that, and across both: 0 for points on one line, or in one plane.
  double length_mm = 0.0;
  double width_mm = 0.0;
  double depth_mm = 0.0;
};

/// Shape: as many `to` as `from`, three at least.  Cost: linear in the points.  Memory: none.
/// Fails: kShapeMismatch, kTooFewPoints (also when all of `from` lie on one line), kNotFinite.
[[nodiscard]] Result<RigidFit> fit_rigid(std::span<const Vec3> from_mm,
                                         std::span<const Vec3> to_mm) noexcept;

}  // namespace flatpose
