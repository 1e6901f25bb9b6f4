#pragma once
// Scans, templates and a locator, in memory and set up as the daemon's are, and the runs on them.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/latency/time.hpp"
#include "bench/scenes/lesson.hpp"
#include "bench/scenes/trial.hpp"
#include "port/linux/realtime/config.hpp"
#include "port/linux/realtime/memory.hpp"
#include "port/linux/realtime/process_setup.hpp"

namespace flatpose::bench {

struct RigConfig {
  std::vector<std::string> scenes;  ///< Of the simulator.
  int seed_count = 8;               ///< Of each scene.
  int columns = 600;
  int rows = 500;
  int max_matches = 1;
  port::RealtimeConfig realtime;
};

/// One whole cycle, then the loops, then a sleep.
struct CycleSample {
  int scan = 0;
  std::int64_t cycle_ns = 0;
  locate::Timings timings;
  locate::Outcome outcome = locate::Outcome::kOk;
  std::int64_t busy_ns = 0;
  std::int64_t memory_ns = 0;
  std::int64_t wake_ns = 0;  ///< How late the sleep ended.
};

struct CycleRun {
  std::vector<CycleSample> samples;
  Events in_cycles;
  Events in_loops;
  port::Steps steps;  ///< Of the threads' set-up.
};

/// One search with a deadline.
struct DeadlineSample {
  int scan = 0;
  std::int64_t usual_us = 0;  ///< What the search takes without one.
  std::int64_t deadline_us = 0;
  std::int64_t elapsed_ns = 0;
  locate::Outcome outcome = locate::Outcome::kOk;
};

class Rig {
 public:
  /// Simulates, teaches, takes the memory and locks it.  Cost: seconds to a minute.
  explicit Rig(const RigConfig& config);

  [[nodiscard]] const std::vector<Shot>& shots() const noexcept { return shots_; }
  [[nodiscard]] const port::Steps& steps() const noexcept { return setup_->steps(); }
  [[nodiscard]] std::size_t arena_bytes() noexcept { return memory_->span().size(); }

  /// Cycles over all scans in ever new order until the time is over.
  [[nodiscard]] CycleRun run_cycles(int thread_count, double seconds);
  /// Searches that are given less time than they would take.
  [[nodiscard]] std::vector<DeadlineSample> run_deadlines(int thread_count, double seconds);

 private:
  struct Hands;
  [[nodiscard]] locate::LocateResult search(int scan, std::int64_t deadline_us, Executor& executor);
  [[nodiscard]] std::vector<std::int64_t> usual_times_us(Executor& executor);
  void cycle(Hands& hands, int scan, std::int64_t busy_steps, CycleRun& run);

  RigConfig config_;
  std::vector<Shot> shots_;
  std::map<std::string, Taught> taught_;
  std::optional<port::PrefaultedMemory> memory_;
  locate::Locator locator_;
  std::optional<port::ProcessSetup> setup_;
};

}  // namespace flatpose::bench
