#pragma once
// Random expressions as straight-line programs, to be run with any number type.

#include <array>
#include <cmath>
#include <cstdint>

#include "flatpose/autodiff/dual.hpp"
#include "tests/lib/autodiff/dual_transcendental.hpp"

namespace flatpose::autodiff {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {  // splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  int below(int limit) { return static_cast<int>(bits() % static_cast<std::uint64_t>(limit)); }
  double uniform(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(bits() >> 11);
  }

 private:
  std::uint64_t state_;
};

constexpr int kInputCount = 3;
constexpr int kInstructionCount = 8;
constexpr int kOperationCount = 18;

struct Instruction {
  int operation;
  int a, b;  // registers
  double constant;
};
using Program = std::array<Instruction, kInstructionCount>;

inline Program random_program(Random& random) {
  Program program;
  for (int k = 0; k < kInstructionCount; ++k) {
    const int known = kInputCount + k;
    program[k] = {random.below(kOperationCount), random.below(known), random.below(known),
                  random.uniform(0.5, 2.0)};
  }
  return program;
}

// Square roots, logarithms and divisors are kept away from 0, where digits are lost.
template <class T>
T step(const Instruction& op, const T& a, const T& b) {
  using autodiff::atan2, autodiff::cos, autodiff::sin, autodiff::sqrt;
  using std::exp, std::log, std::pow;
  const double c = op.constant;
  switch (op.operation) {
    case 0: return a + b;
    case 1: return a - b;
    case 2: return a * b;
    case 3: return a / (1.0 + b * b);
    case 4: return c * a - b * c;
    case 5: return (c - a) + (b - c);
    case 6: return c / (1.0 + a * a);
    case 7: return -a / c + c;
    case 8: return sqrt(c + a * a);
    case 9: return sin(a);
    case 10: return cos(a);
    case 11: return atan2(a, 1.0 + b * b);
    case 12: return exp(-a * a) * b;
    case 13: return log(c + a * a);
    case 14: return pow(c + a * a, 1.5) / (1.0 + a * a);
    case 15: return pow(1.0 + b * b, cos(a));
    case 16: return pow(c, sin(a));
    default: return a < b ? a * c : b * b;
  }
}

template <class T>
T run(const Program& program, const std::array<T, kInputCount>& inputs) {
  std::array<T, kInputCount + kInstructionCount> registers;
  for (int i = 0; i < kInputCount; ++i) registers[i] = inputs[i];
  for (int k = 0; k < kInstructionCount; ++k) {
    const Instruction& op = program[k];
    registers[kInputCount + k] = step<T>(op, registers[op.a], registers[op.b]);
  }
  return registers[kInputCount + kInstructionCount - 1];
}

}  // namespace flatpose::autodiff
