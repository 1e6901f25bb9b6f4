#include "bench/latency/spin.hpp"

#include <array>

namespace flatpose::bench {

// Chains that do not wait for each other, so that the core is as busy as a search keeps it. One
// compiled form for calibration and run.
[[gnu::noinline]] std::uint64_t spin(std::int64_t step_count) noexcept {
  std::array<std::uint64_t, 8> chains{1, 2, 3, 4, 5, 6, 7, 8};
  for (std::int64_t i = 0; i < step_count; ++i) {
    for (std::uint64_t& x : chains) {
      x ^= x << 13;
      x ^= x >> 7;
      x ^= x << 17;
    }
  }
  std::uint64_t sum = 0;
  for (const std::uint64_t x : chains) sum += x;
  return sum;
}

std::uint64_t sweep(std::span<const std::uint64_t> values) noexcept {
  std::uint64_t sum = 0;
  for (const std::uint64_t value : values) sum += value;
  return sum;
}

}  // namespace flatpose::bench
