#pragma once
// exp, log and pow of dual numbers by way of libm, whose last bits differ between machines: for
// tests alone.

#include <cmath>

#include "flatpose/autodiff/dual.hpp"

namespace flatpose::autodiff {

template <int N>
Dual<N> exp(const Dual<N>& a) {
  const double e = std::exp(a.value);
  return a.chain(e, e);
}

template <int N>
Dual<N> log(const Dual<N>& a) {
  return a.chain(std::log(a.value), 1.0 / a.value);
}

template <int N>
Dual<N> pow(const Dual<N>& a, double b) {
  return a.chain(std::pow(a.value, b), b * std::pow(a.value, b - 1.0));
}

template <int N>
Dual<N> pow(double a, const Dual<N>& b) {
  const double p = std::pow(a, b.value);
  return b.chain(p, p * std::log(a));
}

template <int N>
Dual<N> pow(const Dual<N>& a, const Dual<N>& b) {
  Dual<N> out(std::pow(a.value, b.value));
  for (int i = 0; i < N; ++i)
    out.derivative[i] =
        out.value * (b.derivative[i] * std::log(a.value) + b.value * a.derivative[i] / a.value);
  return out;
}

}  // namespace flatpose::autodiff
