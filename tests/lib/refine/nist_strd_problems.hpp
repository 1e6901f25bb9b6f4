#pragma once
// Problems of the NIST Statistical Reference Datasets for nonlinear regression, with their
// certified parameters, standard deviations and residual sums of squares (11 digits).
// Source: https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml, in the public domain.

#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <span>

#include "flatpose/autodiff/dual.hpp"
#include "tests/lib/autodiff/dual_transcendental.hpp"

namespace flatpose::refine::nist {

constexpr int kParameterLimit = 7;
using Parameters = std::array<double, kParameterLimit>;

struct Observation {
  double x, y;
};

struct Prediction {
  double value;
  Parameters derivative;
};

struct Problem {
  const char* name;
  const char* difficulty;
  int parameter_count;
  std::array<Parameters, 2> starts;
  Parameters certified;
  Parameters standard_deviation;
  double residual_square_sum;
  std::span<const Observation> observations;
  Prediction (*predict)(const double* parameters, double x);
  std::array<int, 2> digits;  ///< Asked for from start 1 and 2; 0: this start leads elsewhere.

  friend void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.name; }
};

/// From start 1, far off on purpose, two do not arrive: BoxBOD falls onto the plateau where its
/// exponential is constant (unless damped from the start), MGH10 creeps along a bent valley.
/// The problems, each cross-checked by a test: the certified parameters give the certified sum.
std::span<const Problem> problems();

}  // namespace flatpose::refine::nist
