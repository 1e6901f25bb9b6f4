#pragma once
// Random numbers of our own (SplitMix64: Steele, Lea, Flood 2014), so that a seed means the same
// scan on every machine. Normal numbers by Box and Muller (1958), with our own sine and logarithm.

#include <cstdint>

namespace flatpose::sim {

/// Natural logarithm of a finite x > 0 with the same bits everywhere.  Accuracy: 1e-15 relative to
/// max(1, |ln x|).
[[nodiscard]] double natural_log(double x) noexcept;

class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}
  /// A stream that has nothing to do with those of other keys, e.g. one a pixel.
  Random(std::uint64_t seed, std::uint64_t key) noexcept;

  std::uint64_t bits() noexcept;
  /// In [0, 1), 53 bits.
  double uniform() noexcept;
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// In [0, count).  Limits: 0 < count < 2^31.
  int index(int count) noexcept;

  struct NormalPair {
    double first;
    double second;
  };
  /// Two independent numbers of mean 0 and sigma 1.
  NormalPair normal_pair() noexcept;

 private:
  std::uint64_t state_;
};

}  // namespace flatpose::sim
