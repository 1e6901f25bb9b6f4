#pragma once
// What a search may be given of the machine so that its time varies little. All of it is optional,
// and each field costs somebody else something: a processor, memory, power.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace flatpose::port {

inline constexpr int kPriorityMax = 99;

struct RealtimeConfig {
  /// Thread i of a search runs on cpus[i] and nowhere else; empty: wherever the system likes.
  std::vector<int> cpus;
  /// SCHED_FIFO with this priority, 1 to 99; 0: time-sharing like everything else.
  int priority = 0;
  /// Keeps all of the process in memory, that nothing waits for a page.
  bool lock_memory = false;
  /// Longest that a processor may take to wake up, which keeps it out of deep sleep and warm.
  std::optional<std::int32_t> cpu_latency_us;
  /// How late a timer may be so that several can be served at once; only for threads without
  /// a priority, the others are served on time.
  std::optional<std::int64_t> timer_slack_ns;
};

/// Why a search on so many threads must not run with this config; empty when it may. Threads of one
/// priority do not make room for each other, so each needs a processor.
[[nodiscard]] std::string problem_with(const RealtimeConfig& config, int thread_count);

}  // namespace flatpose::port
