#pragma once
// Automatic differentiation by dual numbers with N derivatives at once (Ingberg 2015, section
// 2.6.4).
//
// A dual number is a value and an infinitesimal part in N directions,
//
//   a = a0 + sum_i a_i e_i,      e_i e_j = 0.                                               (1)
//
// Taylor's series ends after the first term because of (1), so any differentiable f gives
//
//   f(a) = f(a0) + f'(a0) sum_i a_i e_i                                                     (2)
//
// and a function written for a type T yields, with x_i = x_i0 + e_i (`seed`), its value and its
// exact gradient in one pass. Multiplying out and dropping e_i e_j:
//
//   a + b = (a0 + b0) + sum_i (a_i + b_i) e_i                                               (3)
//   a b   = a0 b0     + sum_i (a_i b0 + a0 b_i) e_i                                         (4)
//   a / b = q         + sum_i (a_i - q b_i) / b0 e_i,          q = a0 / b0                  (5)
//
// (5) is (4) solved for q in q b = a. The functions are (2) with
//
//   sqrt' = 1 / (2 sqrt),  sin' = cos,  cos' = -sin,  fabs' = sign                          (6)
//   atan2(y, x) = angle + sum_i (x0 y_i - y0 x_i) / (x0^2 + y0^2) e_i                       (7)
//
// Comparisons look at the value alone, so that a template takes the same branch for double and
// Dual; on a kink (fabs at 0, min and max of equals) the derivative is that of one named side. At
// sqrt(0) and atan2(0, 0) there is none, and it is not finite. For double the functions exist too:
// `using autodiff::sin;` in a template serves both and keeps libm's machine-dependent bits out.
//
// Memory: none.  Thread: reentrant.  Cost: N multiply-adds an operation, unrolled.

#include <array>
#include <cassert>
#include <cmath>
#include <compare>

#include "flatpose/core/maths.hpp"

namespace flatpose::autodiff {

template <int N>
struct Dual {
  static_assert(N > 0);

  double value = 0.0;
  std::array<double, N> derivative{};

  constexpr Dual() = default;
  constexpr Dual(double constant) noexcept : value(constant) {}  // NOLINT: a constant is a dual
  constexpr Dual(double value_in, const std::array<double, N>& derivative_in) noexcept
      : value(value_in), derivative(derivative_in) {}

  /// Equation (2): the function's value and its slope at `value`.
  [[nodiscard]] constexpr Dual chain(double function_value, double slope) const noexcept {
    Dual out(function_value);
    for (int i = 0; i < N; ++i) out.derivative[i] = slope * derivative[i];
    return out;
  }

  constexpr Dual& operator+=(const Dual& b) noexcept { return *this = *this + b; }
  constexpr Dual& operator-=(const Dual& b) noexcept { return *this = *this - b; }
  constexpr Dual& operator*=(const Dual& b) noexcept { return *this = *this * b; }
  constexpr Dual& operator/=(const Dual& b) noexcept { return *this = *this / b; }

  friend constexpr Dual operator+(const Dual& a) noexcept { return a; }
  friend constexpr Dual operator-(const Dual& a) noexcept { return a.chain(-a.value, -1.0); }

  friend constexpr Dual operator+(const Dual& a, const Dual& b) noexcept {  // (3)
    Dual out(a.value + b.value);
    for (int i = 0; i < N; ++i) out.derivative[i] = a.derivative[i] + b.derivative[i];
    return out;
  }
  friend constexpr Dual operator+(const Dual& a, double b) noexcept {
    return {a.value + b, a.derivative};
  }
  friend constexpr Dual operator+(double a, const Dual& b) noexcept { return b + a; }

  friend constexpr Dual operator-(const Dual& a, const Dual& b) noexcept {
    Dual out(a.value - b.value);
    for (int i = 0; i < N; ++i) out.derivative[i] = a.derivative[i] - b.derivative[i];
    return out;
  }
  friend constexpr Dual operator-(const Dual& a, double b) noexcept {
    return {a.value - b, a.derivative};
  }
  friend constexpr Dual operator-(double a, const Dual& b) noexcept {
    return b.chain(a - b.value, -1.0);
  }

  friend constexpr Dual operator*(const Dual& a, const Dual& b) noexcept {  // (4)
    Dual out(a.value * b.value);
    for (int i = 0; i < N; ++i)
      out.derivative[i] = a.derivative[i] * b.value + a.value * b.derivative[i];
    return out;
  }
  friend constexpr Dual operator*(const Dual& a, double b) noexcept {
    return a.chain(a.value * b, b);
  }
  friend constexpr Dual operator*(double a, const Dual& b) noexcept { return b * a; }

  friend constexpr Dual operator/(const Dual& a, const Dual& b) noexcept {  // (5)
    Dual out(a.value / b.value);
    const double reciprocal = 1.0 / b.value;
    for (int i = 0; i < N; ++i)
      out.derivative[i] = (a.derivative[i] - out.value * b.derivative[i]) * reciprocal;
    return out;
  }
  friend constexpr Dual operator/(const Dual& a, double b) noexcept {
    return a.chain(a.value / b, 1.0 / b);
  }
  friend constexpr Dual operator/(double a, const Dual& b) noexcept {
    const double quotient = a / b.value;
    return b.chain(quotient, -quotient / b.value);
  }

  friend constexpr bool operator==(const Dual& a, const Dual& b) noexcept {
    return a.value == b.value;
  }
  friend constexpr std::partial_ordering operator<=>(const Dual& a, const Dual& b) noexcept {
    return a.value <=> b.value;
  }
};

/// The variable number `index` of N: its derivative with respect to itself is one.
template <int N>
[[nodiscard]] constexpr Dual<N> seed(double value, int index) noexcept {
  assert(index >= 0 && index < N);
  Dual<N> out(value);
  out.derivative[index] = 1.0;
  return out;
}

/// The value without its derivatives, for what does not depend on them (the cell of a grid).
[[nodiscard]] constexpr double scalar_part(double a) noexcept { return a; }
template <int N>
[[nodiscard]] constexpr double scalar_part(const Dual<N>& a) noexcept {
  return a.value;
}

[[nodiscard]] inline double sqrt(double a) noexcept { return std::sqrt(a); }
[[nodiscard]] inline double fabs(double a) noexcept { return std::fabs(a); }
[[nodiscard]] inline double sin(double a_rad) noexcept { return sin_cos(a_rad).sin; }
[[nodiscard]] inline double cos(double a_rad) noexcept { return sin_cos(a_rad).cos; }
[[nodiscard]] inline double atan2(double y, double x) noexcept { return arc_tangent(y, x); }
[[nodiscard]] constexpr double min(double a, double b) noexcept { return b < a ? b : a; }
[[nodiscard]] constexpr double max(double a, double b) noexcept { return a < b ? b : a; }

template <int N>
[[nodiscard]] Dual<N> sqrt(const Dual<N>& a) noexcept {  // (6)
  const double root = std::sqrt(a.value);
  return a.chain(root, 0.5 / root);
}

/// At 0 the side above: slope 1.
template <int N>
[[nodiscard]] Dual<N> fabs(const Dual<N>& a) noexcept {  // (6)
  return a.value < 0.0 ? -a : a;
}

template <int N>
[[nodiscard]] Dual<N> sin(const Dual<N>& a_rad) noexcept {  // (6)
  const SinCos at = sin_cos(a_rad.value);
  return a_rad.chain(at.sin, at.cos);
}

template <int N>
[[nodiscard]] Dual<N> cos(const Dual<N>& a_rad) noexcept {  // (6)
  const SinCos at = sin_cos(a_rad.value);
  return a_rad.chain(at.cos, -at.sin);
}

template <int N>
[[nodiscard]] Dual<N> atan2(const Dual<N>& y, const Dual<N>& x) noexcept {  // (7)
  Dual<N> out(arc_tangent(y.value, x.value));
  const double reciprocal = 1.0 / (x.value * x.value + y.value * y.value);
  for (int i = 0; i < N; ++i)
    out.derivative[i] = (x.value * y.derivative[i] - y.value * x.derivative[i]) * reciprocal;
  return out;
}

/// Of equals the first.
template <int N>
[[nodiscard]] constexpr Dual<N> min(const Dual<N>& a, const Dual<N>& b) noexcept {
  return b.value < a.value ? b : a;
}

/// Of equals the first.
template <int N>
[[nodiscard]] constexpr Dual<N> max(const Dual<N>& a, const Dual<N>& b) noexcept {
  return a.value < b.value ? b : a;
}

}  // namespace flatpose::autodiff
