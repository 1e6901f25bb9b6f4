#pragma once
// Time and what the system counts of this process.

#include <sys/resource.h>

#include <chrono>
#include <cstdint>

namespace flatpose::bench {

[[nodiscard]] inline std::int64_t now_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Page faults and context switches of all threads.
struct Events {
  std::int64_t minor_faults = 0;
  std::int64_t major_faults = 0;
  std::int64_t own_switches = 0;     ///< It waited for something.
  std::int64_t forced_switches = 0;  ///< It was stopped.

  static Events now() noexcept {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return {usage.ru_minflt, usage.ru_majflt, usage.ru_nvcsw, usage.ru_nivcsw};
  }
  /// Adds what happened between two looks.
  void add(const Events& from, const Events& to) noexcept {
    minor_faults += to.minor_faults - from.minor_faults;
    major_faults += to.major_faults - from.major_faults;
    own_switches += to.own_switches - from.own_switches;
    forced_switches += to.forced_switches - from.forced_switches;
  }
};

}  // namespace flatpose::bench
