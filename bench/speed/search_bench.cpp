// The search against the thesis's, against the machine's load roof, and against itself without
// early termination.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <functional>
#include <map>
#include <stdexcept>

#include "bench/speed/benches.hpp"
#include "bench/speed/block_sums.hpp"
#include "bench/speed/load_roof.hpp"
#include "bench/speed/paths.hpp"
#include "bench/speed/shots.hpp"
#include "bench/speed/whole_sums.hpp"

namespace flatpose::bench {
namespace {

/// A scene with all that any contender reads of it, made when first asked for.
class Input {
 public:
  explicit Input(const GroundConfig& config)
      : ground_(make_ground(config, taught(config.part).part)), sums_(*ground_) {
    const int side = config.places_per_side;
    if (!config.is_gated && ground_->places.place_count != static_cast<std::int64_t>(side) * side)
      throw std::runtime_error("not every place is a hypothesis");
    candidates_.resize(48);
  }
  [[nodiscard]] double evaluation_count() const { return ground_->evaluation_count(); }
  [[nodiscard]] double loaded_bytes(int lane_count) const { return sums_.loaded_bytes(lane_count); }

  void search_as_thesis(thesis::Form form) {
    benchmark::DoNotOptimize(thesis::search(thesis_->images, thesis_->cloud, thesis_->tilts, form));
  }
  void prepare_thesis() {
    if (!thesis_) thesis_ = std::make_unique<ThesisGround>(make_thesis_ground(*ground_));
  }
  void sum(search::SearchBlock form) {
    sums_.run(form);
    benchmark::ClobberMemory();
  }
  [[nodiscard]] std::uint64_t digest(search::SearchBlock form) {
    sums_.run(form);
    return sums_.digest();
  }
  void prune(VectorPath path) {
    sums_.prune(path);
    benchmark::ClobberMemory();
  }
  /// That pruning leaves the list of candidates as it is. Where the first round's list is not full
  /// there is a second, as the search has it.
  void check_pruning(VectorPath path) {
    sums_.prune(path);
    if (sums_.candidates(candidates_.size()).size() < candidates_.size() &&
        sums_.round_count() < 2) {
      sums_.add_round();
      sums_.prune(path);
    }
    const auto pruned = sums_.candidates(candidates_.size());
    sums_.run(search::search_block_for(path));
    const auto whole = sums_.candidates(candidates_.size());
    const auto is_same = [](const search::Candidate& a, const search::Candidate& b) {
      return a.cost_q10 == b.cost_q10 && a.row == b.row && a.column == b.column &&
             a.angle_index == b.angle_index;
    };
    if (!std::equal(pruned.begin(), pruned.end(), whole.begin(), whole.end(), is_same))
      throw std::runtime_error("pruning changes the candidates");
  }
  /// Touches the pages of the scratch memory, so that no contender pays for them.
  void warm() {
    if (!is_warm_) search(VectorPath::kPortable);
    is_warm_ = true;
  }
  void search(VectorPath path) {
    search::GridSearchConfig config = ground_->search;
    config.vector_path = path;
    const auto found =
        search::grid_search(ground_->images, ground_->field, ground_->places, *ground_->part, 0,
                            config, ground_->scratch, candidates_);
    if (!found) throw std::runtime_error(std::string("grid_search: ") + to_string(found.status()));
  }

 private:
  std::unique_ptr<Ground> ground_;
  BlockSums sums_;
  std::unique_ptr<ThesisGround> thesis_;
  std::vector<search::Candidate> candidates_;
  bool is_warm_ = false;
};

struct Row {
  std::string name;
  GroundConfig config;
  bool with_thesis = true;
};

/// Table 4.1 of Ingberg 2015: all positions; only planar ones, as ours has it; with normals instead
/// of heights, as the thesis has it; and all positions at one tilt.
std::vector<Row> table_4_1() {
  const auto row = [](const std::string& scene, int side, int points) {
    GroundConfig config;
    config.scene = scene;
    config.part = part_in(scene);
    config.places_per_side = side;
    config.angle_count = side;
    config.point_count = points;
    return Row{scene, config};
  };
  std::vector<Row> rows{row("lone", 240, 14),     row("low", 240, 12),
                        row("medium", 220, 16),   row("high", 220, 18),
                        row("pile", 180, 28),     row("cyl_loose", 6700, 4),
                        row("cyl_grid", 6700, 4), row("cyl_brick", 6700, 4)};
  const std::size_t planar_count = 6;  // the pads, and cylinders once
  for (std::size_t i = 0; i < planar_count; ++i) {
    Row planar = rows[i];
    planar.name += "_planar";
    planar.config.is_gated = true;
    rows.push_back(planar);
  }
  Row normals = row("medium", 220, 16);
  normals.name = "medium_normals";
  normals.config.use_height = normals.config.use_directions = false;
  rows.push_back(normals);
  for (Row level : {row("lone", 240, 14), normals}) {
    level.name += "_level";
    level.config.is_level = true;
    rows.push_back(level);
  }
  return rows;
}

/// The search as locate runs it, of planar places only, at two angle steps.
std::vector<Row> pruned() {
  std::vector<Row> rows;
  for (const int angles : {240, 720}) {
    GroundConfig config;
    config.scene = "medium";
    config.places_per_side = 240;
    config.angle_count = angles;
    config.point_count = 28;
    config.is_gated = true;
    config.node_side = 2;
    config.node_slack = angles > 360 ? 1 : 0;  // angles that move no point by a place
    config.first_share = 0.56;
    rows.push_back({"medium_" + std::to_string(angles), config, false});
  }
  return rows;
}

using Inputs = std::vector<std::unique_ptr<Input>>;

Inputs& inputs_of(const Row& row, int count) {
  static std::map<std::string, Inputs> kept;
  Inputs& inputs = kept[row.name];
  const int wanted = row.config.places_per_side > 1000 ? 1 : count;
  while (static_cast<int>(inputs.size()) < wanted) {
    GroundConfig config = row.config;
    config.seed = inputs.size();
    inputs.push_back(std::make_unique<Input>(config));
  }
  return inputs;
}

using Contender = std::function<void(Input&)>;

/// One iteration is every input once.
void add(
    const std::string& group, const Row& row, const std::string& name, int count,
    const Contender& contender, const Contender& prepare = [](Input&) {}, int lane_count = 0) {
  benchmark::RegisterBenchmark((group + "/" + row.name + "/" + name).c_str(), [=](benchmark::State&
                                                                                      state) {
    Inputs& inputs = inputs_of(row, count);
    double evaluations = 0.0;
    double bytes = 0.0;
    for (const auto& input : inputs) {
      prepare(*input);
      evaluations += input->evaluation_count();
      if (lane_count > 0) bytes += input->loaded_bytes(lane_count);
    }
    for (auto _ : state) {
      for (const auto& input : inputs) contender(*input);
    }
    const auto rate = benchmark::Counter::kIsIterationInvariantRate;
    state.counters["evaluations_per_s"] = benchmark::Counter(evaluations, rate);
    if (lane_count > 0) state.counters["loaded_bytes_per_s"] = benchmark::Counter(bytes, rate);
    state.counters["evaluations"] = evaluations;
  })->Unit(benchmark::kMillisecond);
}

void add_ours(const std::string& group, const Row& row, const NamedPath& path, int count) {
  const search::SearchBlock early = search::search_block_for(path.path);
  const search::SearchBlock whole = whole_sums_for(path.path);
  add(group, row, "sums_" + path.name, count, [=](Input& input) { input.sum(early); });
  add(
      group, row, "search_" + path.name, count, [=](Input& input) { input.search(path.path); },
      [](Input& input) { input.warm(); });
  if (row.config.node_side > 0) {
    add(
        group, row, "pruned_" + path.name, count, [=](Input& input) { input.prune(path.path); },
        [=](Input& input) { input.check_pruning(path.path); });
  }
  if (whole == nullptr) return;
  add(
      group, row, "whole_" + path.name, count, [=](Input& input) { input.sum(whole); },
      [=](Input& input) {
        if (input.digest(early) != input.digest(whole))
          throw std::runtime_error("early termination changes costs");
      },
      16 << static_cast<int>(path.path));
}

void register_row(const std::string& group, const Row& row, int count) {
  const Contender prepare = [](Input& input) { input.prepare_thesis(); };
  if (row.with_thesis) {
    add(
        group, row, "thesis", count,
        [](Input& input) { input.search_as_thesis(thesis::Form::kProjecting); }, prepare);
    add(
        group, row, "thesis_tabled", count,
        [](Input& input) { input.search_as_thesis(thesis::Form::kTabled); }, prepare);
  }
  for (const NamedPath& path : vector_paths()) add_ours(group, row, path, count);
}

void register_roof(const NamedPath& path) {
  struct Level {
    const char* name;
    std::size_t size_bytes;
  };
  for (const Level level : {Level{"L1", kL1Bytes}, Level{"L2", kL2Bytes}}) {
    for (const int offset : {0, 1}) {
      const std::string name = std::string("roof/") + level.name + "_" +
                               (offset == 0 ? "aligned" : "any_byte") + "/" + path.name;
      benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        std::vector<std::uint8_t> memory(level.size_bytes + kLoadPaddingBytes, 1);
        const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
        const std::uint8_t* first = memory.data() + (64 - address % 64) + offset;
        const LoadAll load = load_all_for(path.path);
        for (auto _ : state) {
          for (int i = 0; i < 16; ++i) load(first, level.size_bytes);
        }
        state.counters["loaded_bytes_per_s"] =
            benchmark::Counter(16.0 * static_cast<double>(level.size_bytes),
                               benchmark::Counter::kIsIterationInvariantRate);
      });
    }
  }
}

}  // namespace

void register_search_benches(const BenchOptions& options) {
  for (const Row& row : table_4_1()) register_row("search", row, options.ground_count);
  for (const Row& row : pruned()) register_row("prune", row, options.ground_count);
  for (const NamedPath& path : vector_paths()) register_roof(path);
}

}  // namespace flatpose::bench
