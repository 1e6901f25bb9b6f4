#include "port/sim/random.hpp"

#include <cmath>
#include <numbers>

#include "flatpose/core/maths.hpp"

namespace flatpose::sim {

double natural_log(double x) noexcept {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)), then ln m = 2 atanh(z), z = (m - 1) / (m + 1).
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < std::numbers::sqrt2 / 2.0) {
    m *= 2.0;
    --exponent;
  }
  const double z = (m - 1.0) / (m + 1.0);
  const double z2 = z * z;  // at most 0.0295: eleven terms reach the last bit
  double sum = 0.0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * z2 + 1.0 / k;
  return 2.0 * z * sum + exponent * std::numbers::ln2;
}

Random::Random(std::uint64_t seed, std::uint64_t key) noexcept : state_(seed) {
  state_ = bits() ^ (key * 0xD1B54A32D192ED03ULL);
  state_ = bits();
}

std::uint64_t Random::bits() noexcept {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double Random::uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

int Random::index(int count) noexcept {
  const std::uint64_t high = bits() >> 32;
  return static_cast<int>((high * static_cast<std::uint64_t>(count)) >> 32);
}

Random::NormalPair Random::normal_pair() noexcept {
  const double radius = std::sqrt(-2.0 * natural_log(1.0 - uniform()));  // 1 - u is never 0
  const auto [s, c] = sin_cos(2.0 * kPi * uniform());
  return {radius * c, radius * s};
}

}  // namespace flatpose::sim
