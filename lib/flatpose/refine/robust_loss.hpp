#pragma once
// Robust losses for least squares: how much of a large residual is believed.
//
// With the scale c > 0 in units of the residual r:
//
//   none    rho = r^2 / 2                                              omega = 1            (1)
//   Huber   rho = r^2 / 2           for |r| <= c, else c |r| - c^2/2   omega = 1, c / |r|   (2)
//   Tukey   rho = c^2/6 (1 - u^3)   for |r| <= c, else c^2/6           omega = u^2, 0       (3)
//           u = 1 - (r/c)^2
//
// omega = rho'(r) / r is the weight with which r enters the normal equations (iteratively
// reweighted least squares); all three losses are r^2 / 2 for small r.
// Source: Huber 1964; Beaton and Tukey 1974.

#include <cmath>

namespace flatpose::refine {

enum class LossKind { kNone, kHuber, kTukey };

struct LossValue {
  double cost;    ///< rho
  double weight;  ///< omega
};

struct RobustLoss {
  LossKind kind = LossKind::kNone;
  double scale = 1.0;  ///< c, in the unit of the residual, above 0; not used by kNone.

  static RobustLoss huber(double scale) noexcept { return {LossKind::kHuber, scale}; }
  static RobustLoss tukey(double scale) noexcept { return {LossKind::kTukey, scale}; }

  [[nodiscard]] LossValue operator()(double residual) const noexcept {
    const double square = residual * residual;
    if (kind == LossKind::kHuber && std::fabs(residual) > scale) {
      return {scale * (std::fabs(residual) - 0.5 * scale), scale / std::fabs(residual)};
    }
    if (kind == LossKind::kTukey) {
      const double full = scale * scale / 6.0;
      if (std::fabs(residual) > scale) return {full, 0.0};
      const double ratio = square / (scale * scale);
      const double u = 1.0 - ratio;
      // 1 - u^3 = (1 - u) (1 + u + u^2): no digits cancel for small residuals.
      return {full * ratio * (1.0 + u + u * u), u * u};
    }
    return {0.5 * square, 1.0};
  }
};

}  // namespace flatpose::refine
