#pragma once
// Sine, cosine and arc tangent of our own: libm's differ in the last bits between machines, and a
// pose must not. Only +, -, *, / and sqrt are used, which IEEE 754 rounds alike everywhere (no
// contraction: -ffp-contract=off).

#include <cmath>
#include <numbers>

namespace flatpose {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegPerRad = 180.0 / kPi;
inline constexpr double kRadPerDeg = kPi / 180.0;

struct SinCos {
  double sin;
  double cos;
};

/// Sine and cosine.  Units: rad.  Fails: NaN beyond +-1e6 rad.  Accuracy: 2e-15 (tested against
/// libm).
[[nodiscard]] SinCos sin_cos(double angle_rad) noexcept;

/// The angle of (x, y) in (-pi, pi]; 0 for (0, 0).  Accuracy: 2e-15 (tested against libm).
[[nodiscard]] double arc_tangent(double y, double x) noexcept;

/// The angle in [0, pi] whose cosine is `cosine`, which is clamped to [-1, 1].
[[nodiscard]] inline double arc_cosine(double cosine) noexcept {
  const double c = cosine > 1.0 ? 1.0 : (cosine < -1.0 ? -1.0 : cosine);
  return arc_tangent(std::sqrt((1.0 - c) * (1.0 + c)), c);
}

/// The nearest whole number, halves up; a billion beyond +-a billion.  Cost: no call, unlike
/// std::floor() where the processor is only promised to have SSE2.
[[nodiscard]] inline int rounded(double value) noexcept {
  const double half_up = value + 0.5;
  const double held = half_up > 1e9 ? 1e9 : (half_up > -1e9 ? half_up : -1e9);
  const int towards_zero = static_cast<int>(held);
  return towards_zero - (held < towards_zero ? 1 : 0);
}

/// The same angle in [-pi, pi).
[[nodiscard]] inline double wrap_angle(double angle_rad) noexcept {
  return angle_rad - 2.0 * kPi * std::floor((angle_rad + kPi) / (2.0 * kPi));
}

}  // namespace flatpose
