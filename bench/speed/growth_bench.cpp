// How the cost grows with the field, the resolution, the angle steps, the control points and the
// instances asked for: each sweep changes one of them.

#include <benchmark/benchmark.h>

#include <chrono>
#include <functional>
#include <map>
#include <stdexcept>

#include "bench/scenes/trial.hpp"
#include "bench/speed/benches.hpp"
#include "bench/speed/ground.hpp"
#include "bench/speed/shots.hpp"
#include "port/linux/cpu/vector_path.hpp"

namespace flatpose::bench {
namespace {

/// Time of an iteration, by stage; a sweep of the search alone fills that.
struct Cost {
  double search_us = 0.0;
  double total_us = 0.0;
};

void add(const std::string& sweep, double x, const std::function<Cost()>& run) {
  benchmark::RegisterBenchmark(
      ("growth/" + sweep + "/" + std::to_string(static_cast<int>(x * 100.0))).c_str(),
      [=](benchmark::State& state) {
        benchmark::DoNotOptimize(run());  // what is made once, and warm
        Cost sum;
        for (auto _ : state) {
          const Cost cost = run();
          sum.search_us += cost.search_us;
          sum.total_us += cost.total_us;
        }
        state.counters["x"] = x;
        const auto mean = benchmark::Counter::kAvgIterations;
        state.counters["search_us"] = benchmark::Counter(sum.search_us, mean);
        if (sum.total_us > 0.0) state.counters["total_us"] = benchmark::Counter(sum.total_us, mean);
      })
      ->Unit(benchmark::kMillisecond);
}

Cost locate(const Shot& shot, const locate::LocateConfig& config) {
  static Searcher searcher;
  const locate::LocateResult result =
      searcher.locate(shot, taught(shot.part).part, config, port::best_vector_path());
  return {static_cast<double>(result.timings.search_us),
          static_cast<double>(result.timings.total_us)};
}

/// Pads apart on a floor of any size, scanned at 1 mm.
const Shot& shot_of_field(int field_x_mm, int field_y_mm) {
  static std::map<int, Shot> kept;
  const auto found = kept.find(field_x_mm);
  if (found != kept.end()) return found->second;
  ShotConfig config;
  config.scene.scene = "lone";
  config.sensor.field_x_mm = config.sensor.columns = field_x_mm;
  config.sensor.field_y_mm = config.sensor.rows = field_y_mm;
  return kept.emplace(field_x_mm, take_shot(config)).first->second;
}

void sweep_field() {
  for (const int field_x_mm : {480, 600, 780, 1000, 1300}) {
    const int field_y_mm = field_x_mm * 5 / 6;
    add("cells_of_the_field", 1e-3 * field_x_mm * field_y_mm,
        [=] { return locate(shot_of_field(field_x_mm, field_y_mm), {}); });
  }
}

void sweep_resolution() {
  for (const double cell_mm : {2.0, 1.4, 1.0, 0.7, 0.5}) {
    add("cells_per_mm", 1.0 / cell_mm, [=] {
      locate::LocateConfig config;
      config.cell_mm = cell_mm;
      return locate(shots_of("medium", "pad", kLargeScan, 2)[0], config);
    });
  }
}

Cost search(int angle_count, int point_count) {
  static std::map<std::pair<int, int>, std::unique_ptr<Ground>> kept;
  auto& ground = kept[{angle_count, point_count}];
  if (!ground) {
    GroundConfig config;
    config.scene = "medium";
    config.is_gated = true;
    config.angle_count = angle_count;
    config.point_count = point_count;
    ground = make_ground(config, taught("pad").part);
    ground->search.vector_path = port::best_vector_path();
  }
  std::array<search::Candidate, 48> candidates;
  const auto start = std::chrono::steady_clock::now();
  const auto found =
      search::grid_search(ground->images, ground->field, ground->places, *ground->part, 0,
                          ground->search, ground->scratch, candidates);
  const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
  if (!found) throw std::runtime_error(std::string("grid_search: ") + to_string(found.status()));
  return {spent.count(), 0.0};
}

void sweep_search() {
  for (const int angle_count : {45, 90, 180, 360, 720})
    add("angles", angle_count, [=] { return search(angle_count, 28); });
  for (const int point_count : {4, 8, 16, 32})
    add("control_points", point_count, [=] { return search(120, point_count); });
}

void sweep_instances() {
  for (const int max_matches : {1, 2, 4, 8, 16, 32}) {
    add("instances", max_matches, [=] {
      locate::LocateConfig config;
      config.max_matches = max_matches;
      return locate(shots_of("cyl_grid", "cylinder", kSmallScan, 2)[0], config);
    });
  }
}

}  // namespace

void register_growth_benches(const BenchOptions&) {
  sweep_field();
  sweep_resolution();
  sweep_search();
  sweep_instances();
}

}  // namespace flatpose::bench
