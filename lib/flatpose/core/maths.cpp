#include "flatpose/core/maths.hpp"

#include <limits>

namespace flatpose {
namespace {

// Taylor series on [-pi/4, pi/4]: the first term left out is below 1e-18 there.
double sin_kernel(double x) noexcept {
  const double q = x * x;
  double sum = 1.0;
  for (int k = 17; k >= 3; k -= 2) sum = 1.0 - q / (k * (k - 1)) * sum;
  return x * sum;
}

double cos_kernel(double x) noexcept {
  const double q = x * x;
  double sum = 1.0;
  for (int k = 18; k >= 2; k -= 2) sum = 1.0 - q / (k * (k - 1)) * sum;
  return sum;
}

// atan on [0, 1]: halve the argument's angle three times, then the odd series.
// tan(a/2) = t / (1 + sqrt(1 + t^2)), so |t| <= tan(pi/32) < 0.0985 and t^17/17 < 1e-18.
double atan_kernel(double t) noexcept {
  constexpr int kHalvings = 3;
  for (int i = 0; i < kHalvings; ++i) t = t / (1.0 + std::sqrt(1.0 + t * t));
  const double q = t * t;
  double sum = 0.0;
  for (int k = 17; k >= 1; k -= 2) sum = 1.0 / k - q * sum;
  return (1 << kHalvings) * t * sum;
}

}  // namespace

SinCos sin_cos(double angle_rad) noexcept {
  constexpr double kAngleLimit_rad = 1e6;
  if (!(std::fabs(angle_rad) <= kAngleLimit_rad)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
  // pi/2 in two parts, so that the reduction keeps its low bits.
  constexpr double kHalfPiHigh = 1.5707963267341256;
  constexpr double kHalfPiLow = 6.077100506506192e-11;
  const double quarter_turns = std::floor(angle_rad / (kPi / 2.0) + 0.5);
  const double x = (angle_rad - quarter_turns * kHalfPiHigh) - quarter_turns * kHalfPiLow;
  const double s = sin_kernel(x);
  const double c = cos_kernel(x);
  switch (static_cast<long>(quarter_turns) & 3) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

double arc_tangent(double y, double x) noexcept {
  if (x == 0.0 && y == 0.0) return 0.0;
  const double ax = std::fabs(x);
  const double ay = std::fabs(y);
  double angle_rad = ay <= ax ? atan_kernel(ay / ax) : kPi / 2.0 - atan_kernel(ax / ay);
  if (x < 0.0) angle_rad = kPi - angle_rad;
  return y < 0.0 ? -angle_rad : angle_rad;
}

}  // namespace flatpose
