// What heights and exclusions do to a cycle: every seed of a scene once without and once with each
// bound, one after the other, so that what else the machine does hits all alike.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <map>

#include "bench/speed/benches.hpp"
#include "bench/speed/shots.hpp"

namespace flatpose::bench {
namespace {

/// The half of the field on one side of a line along y.
Region half_beyond(double x_mm, bool is_upper) {
  constexpr double kFar_mm = 2000.0;
  Region region;
  region.kind = Region::Kind::kBox;
  region.vertex_count = 2;
  region.vertex_x_mm = {x_mm, x_mm + (is_upper ? kFar_mm : -kFar_mm)};
  region.vertex_y_mm = {-kFar_mm, kFar_mm};
  return region;
}

/// The ways in which a search is bounded, about what it finds without: heights that hold it, the
/// half of the field where it is not, and the half where it is; without a find about the middle.
struct Bounds {
  std::array<Region, 1> free_half;
  std::array<Region, 1> found_half;
  std::map<std::string, locate::LocateConfig> configs;

  explicit Bounds(const locate::LocateResult& plain) {
    constexpr double kReach_mm = 15.0;
    const Vec3 p =
        plain.match_count > 0 ? plain.matches[0].face_T_object.position_mm : Vec3{1.0, 0.0, 8.0};
    free_half[0] = half_beyond(0.0, p.x < 0.0);
    found_half[0] = half_beyond(0.0, p.x >= 0.0);
    configs["none"] = {};
    configs["wide"].height_max_mm = 1e6;  // the asking alone
    configs["heights"].height_min_mm = p.z - kReach_mm;
    configs["heights"].height_max_mm = p.z + kReach_mm;
    configs["elsewhere"].exclusions = free_half;
    configs["upon_it"].exclusions = found_half;
  }
  Bounds(const Bounds&) = delete;
  Bounds& operator=(const Bounds&) = delete;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

void run_bounded(benchmark::State& state, const std::string& scene, const ScanSize& size,
                 int seed_count) {
  const std::vector<Shot>& shots = shots_of(scene, part_in(scene), size, seed_count);
  const model::Template& part = taught(part_in(scene)).part;
  Searcher searcher;
  std::map<std::string, std::vector<double>> samples;
  std::map<std::string, double> found;
  for (auto _ : state) {
    for (int i = 0; i < seed_count; ++i) {
      const Shot& shot = shots[static_cast<std::size_t>(i)];
      const Bounds bounds(searcher.locate(shot, part, {}));
      for (const auto& [name, config] : bounds.configs) {
        const locate::LocateResult result = searcher.locate(shot, part, config);
        const locate::Timings& t = result.timings;
        samples[name + "_search_us"].push_back(static_cast<double>(t.search_us));
        samples[name + "_refine_verify_us"].push_back(
            static_cast<double>(t.refine_us + t.verify_us));
        samples[name + "_total_us"].push_back(static_cast<double>(t.total_us));
        samples[name + "_hypotheses"].push_back(static_cast<double>(result.hypothesis_count));
        samples[name + "_candidates"].push_back(static_cast<double>(result.candidate_count));
        found[name + "_found"] += result.match_count;
      }
    }
  }
  for (const auto& [name, values] : samples) state.counters[name] = median(values);
  for (const auto& [name, count] : found) state.counters[name] = count;
}

}  // namespace

void register_bounds_benches(const BenchOptions& options) {
  for (const std::string scene : {"lone", "pile", "absent"}) {
    benchmark::RegisterBenchmark(
        ("bounds/" + kSmallScan.name + "/" + scene).c_str(),
        [=](benchmark::State& state) { run_bounded(state, scene, kSmallScan, options.seed_count); })
        ->Iterations(1)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace flatpose::bench
