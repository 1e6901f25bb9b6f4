// flatpose_latency: whole cycles, one after the other, each beside loops that always do the same.
// run_latency.py drives it: it says on standard input what to run next, a line each,
//
//   cycles PHASE THREADS SECONDS
//   deadlines PHASE THREADS SECONDS
//
// and reads lines of JSON: "setup", a "scan" each, "begin", samples, "end". Nothing is printed
// while anything is measured.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/latency/rig.hpp"
#include "port/sim/simulate.hpp"

namespace flatpose::bench {
namespace {

using nlohmann::ordered_json;

void print(const ordered_json& json) {
  std::printf("%s\n", json.dump().c_str());
  std::fflush(stdout);
}

ordered_json json_of(const port::Steps& steps) {
  ordered_json list = ordered_json::array();
  for (const port::Step& step : steps)
    list.push_back({{"is_done", step.is_done}, {"text", port::line_of(step)}});
  return list;
}

ordered_json json_of(const Events& events) {
  return {{"minor_faults", events.minor_faults},
          {"major_faults", events.major_faults},
          {"own_switches", events.own_switches},
          {"forced_switches", events.forced_switches}};
}

void print_setup(Rig& rig) {
  print({{"kind", "setup"},
         {"arena_bytes", rig.arena_bytes()},
         {"scan_count", rig.shots().size()},
         {"steps", json_of(rig.steps())}});
  for (std::size_t i = 0; i < rig.shots().size(); ++i) {
    const Shot& shot = rig.shots()[i];
    print({{"kind", "scan"}, {"scan", i}, {"scene", shot.scene}, {"seed", shot.seed}});
  }
}

void run_cycles(Rig& rig, int thread_count, double seconds) {
  const CycleRun run = rig.run_cycles(thread_count, seconds);
  for (const CycleSample& s : run.samples) {
    std::printf(
        "{\"c\":[%d,%lld,%lld,%lld,%lld,%lld,%lld,%lld,%lld,%lld,%lld,%d]}\n", s.scan,
        static_cast<long long>(s.cycle_ns), static_cast<long long>(s.busy_ns),
        static_cast<long long>(s.memory_ns), static_cast<long long>(s.wake_ns),
        static_cast<long long>(s.timings.total_us), static_cast<long long>(s.timings.rectify_us),
        static_cast<long long>(s.timings.features_us), static_cast<long long>(s.timings.search_us),
        static_cast<long long>(s.timings.refine_us), static_cast<long long>(s.timings.verify_us),
        static_cast<int>(s.outcome));
  }
  print({{"kind", "end"},
         {"count", run.samples.size()},
         {"in_cycles", json_of(run.in_cycles)},
         {"in_loops", json_of(run.in_loops)},
         {"steps", json_of(run.steps)}});
}

void run_deadlines(Rig& rig, int thread_count, double seconds) {
  const std::vector<DeadlineSample> samples = rig.run_deadlines(thread_count, seconds);
  for (const DeadlineSample& s : samples)
    std::printf("{\"d\":[%d,%lld,%lld,%lld,%d]}\n", s.scan, static_cast<long long>(s.usual_us),
                static_cast<long long>(s.deadline_us), static_cast<long long>(s.elapsed_ns),
                static_cast<int>(s.outcome));
  print({{"kind", "end"}, {"count", samples.size()}});
}

/// False when the line is none.
bool obey(Rig& rig, const std::string& line) {
  std::istringstream words(line);
  std::string what;
  std::string phase;
  int thread_count = 0;
  double seconds = -1.0;
  if (!(words >> what >> phase >> thread_count >> seconds)) return false;
  if (thread_count < 1 || thread_count > 64 || !(seconds >= 0.0)) return false;
  if (what != "cycles" && what != "deadlines") return false;
  print({{"kind", "begin"}, {"phase", phase}, {"what", what}, {"threads", thread_count}});
  what == "cycles" ? run_cycles(rig, thread_count, seconds)
                   : run_deadlines(rig, thread_count, seconds);
  return true;
}

int run(const RigConfig& config) {
  Rig rig(config);
  print_setup(rig);
  for (std::string line; std::getline(std::cin, line);) {
    if (obey(rig, line)) continue;
    std::fprintf(stderr, "flatpose_latency: not understood: %s\n", line.c_str());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace flatpose::bench

int main(int argc, char** argv) {
  using namespace flatpose;
  bench::RigConfig config;
  config.scenes = sim::scene_names();
  std::int32_t cpu_latency_us = -1;
  CLI::App app{"Whole cycles beside a busy loop; commands on standard input, JSON lines out"};
  app.add_option("--scenes", config.scenes, "of the simulator (all)")->delimiter(',');
  app.add_option("--seeds", config.seed_count, "scans of each scene (8)")
      ->check(CLI::Range(1, 1000));
  app.add_option("--cols", config.columns, "points along x (600)")->check(CLI::Range(2, 8192));
  app.add_option("--rows", config.rows, "points along y (500)")->check(CLI::Range(2, 8192));
  app.add_option("--max-matches", config.max_matches, "of a search (1)")
      ->check(CLI::Range(1, locate::kMatchCountMax));
  app.add_option("--cpus", config.realtime.cpus, "of the threads, e.g. 1,0")->delimiter(',');
  app.add_option("--priority", config.realtime.priority, "SCHED_FIFO (0: none)")
      ->check(CLI::Range(0, port::kPriorityMax));
  app.add_flag("--lock-memory", config.realtime.lock_memory, "keep all of it in memory");
  app.add_option("--cpu-latency-us", cpu_latency_us, "longest wake-up of a processor");
  CLI11_PARSE(app, argc, argv);
  if (cpu_latency_us >= 0) config.realtime.cpu_latency_us = cpu_latency_us;
  try {
    return bench::run(config);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flatpose_latency: %s\n", error.what());
    return 3;
  }
}
