// The whole cycle, scan in memory to poses, by stage: every seed of a scene once on every path, one
// after the other, so that what else the machine does hits all alike. Beside it one plain pass over
// the scan.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>

#include "bench/scenes/trial.hpp"
#include "bench/speed/benches.hpp"
#include "bench/speed/paths.hpp"
#include "bench/speed/shots.hpp"
#include "port/linux/threads/worker_pool.hpp"

namespace flatpose::bench {
namespace {

/// The sum of all coordinates that are there.
float plain_pass(const Shot& shot) {
  float sum = 0.0F;
  for (const float value : shot.loaded.scan.xyz_mm) sum += value == value ? value : 0.0F;
  return sum;
}

double plain_pass_us(const Shot& shot) {
  const auto start = std::chrono::steady_clock::now();
  benchmark::DoNotOptimize(plain_pass(shot));
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

using Samples = std::map<std::string, std::vector<double>>;

/// `run` is a path's name, with kTwoThreads behind it where two threads ran.
constexpr const char* kTwoThreads = "_2_threads";

void note(const locate::Timings& t, const std::string& run, Samples& samples) {
  const std::pair<const char*, std::int64_t> stages[] = {
      {"rectify", t.rectify_us}, {"features", t.features_us}, {"search", t.search_us},
      {"refine", t.refine_us},   {"verify", t.verify_us},     {"total", t.total_us}};
  for (const auto& [stage, time_us] : stages)
    samples[run + "_" + stage + "_us"].push_back(static_cast<double>(time_us));
}

void run_cycles(benchmark::State& state, const std::string& scene, const ScanSize& size,
                int seed_count) {
  const std::vector<Shot>& shots = shots_of(scene, part_in(scene), size, seed_count);
  const model::Template& part = taught(part_in(scene)).part;
  Searcher searcher;
  benchmark::DoNotOptimize(
      searcher.locate(shots[0], part, {}, vector_paths().back().path));  // warm
  port::WorkerPool two_threads(2);
  Samples samples;
  for (auto _ : state) {
    for (int i = 0; i < seed_count; ++i) {
      const Shot& shot = shots[static_cast<std::size_t>(i)];
      samples["pass_us"].push_back(plain_pass_us(shot));
      std::uint64_t first_digest = 0;
      for (const NamedPath& path : vector_paths()) {
        const locate::LocateResult result = searcher.locate(shot, part, {}, path.path);
        note(result.timings, path.name, samples);
        const std::uint64_t digest = locate::digest(result);
        if (path.path == VectorPath::kPortable) first_digest = digest;
        const locate::LocateResult shared = searcher.locate(shot, part, {}, path.path, two_threads);
        note(shared.timings, path.name + kTwoThreads, samples);
        if (digest != first_digest || locate::digest(shared) != first_digest)
          throw std::runtime_error("paths or threads differ in " + shot.loaded.path);
      }
    }
  }
  for (const auto& [name, values] : samples) state.counters[name] = median(values);
}

}  // namespace

void register_cycle_benches(const BenchOptions& options) {
  for (const ScanSize& size : {kSmallScan, kLargeScan}) {
    for (const std::string scene :
         {"lone", "low", "medium", "high", "pile", "absent", "cyl_loose", "cyl_grid"}) {
      benchmark::RegisterBenchmark(
          ("cycle/" + size.name + "/" + scene).c_str(),
          [=](benchmark::State& state) { run_cycles(state, scene, size, options.seed_count); })
          ->Iterations(1)
          ->UseRealTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace flatpose::bench
