#include "bench/latency/spin.hpp"

#include <algorithm>

#include "bench/latency/time.hpp"

namespace flatpose::bench {

std::uint64_t spin(std::int64_t step_count) noexcept {
  std::uint64_t state = 1;
  for (std::int64_t i = 0; i < step_count; ++i)
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
  return state;
}

std::int64_t spin_steps_for(std::int64_t time_ns) noexcept {
  constexpr std::int64_t kTrySteps = 500'000;
  std::int64_t best_ns = INT64_MAX;
  volatile std::uint64_t kept = 0;
  for (int i = 0; i < 20; ++i) {
    const std::int64_t start_ns = now_ns();
    kept = spin(kTrySteps);
    best_ns = std::min(best_ns, now_ns() - start_ns);
  }
  static_cast<void>(kept);
  return static_cast<std::int64_t>(static_cast<double>(kTrySteps) * static_cast<double>(time_ns) /
                                   static_cast<double>(std::max<std::int64_t>(best_ns, 1)));
}

std::uint64_t sweep(std::span<const std::uint64_t> values) noexcept {
  std::uint64_t sum = 0;
  for (const std::uint64_t value : values) sum += value;
  return sum;
}

}  // namespace flatpose::bench
