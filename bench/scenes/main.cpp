// flatpose_scenes: trials on simulated scenes, one line of JSON each. run_scenes.py drives it.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bench/scenes/cause.hpp"
#include "bench/scenes/lesson.hpp"
#include "bench/scenes/line.hpp"
#include "bench/scenes/picture.hpp"
#include "bench/scenes/sensors.hpp"
#include "bench/scenes/trial.hpp"
#include "flatpose/core/maths.hpp"
#include "port/linux/files/atomic_file.hpp"

namespace flatpose::bench {
namespace {

constexpr int kProbesMax = 3;  // a trial; each costs a search

struct Options {
  sim::SceneConfig scene;
  std::string sensor = "standard";
  std::string pictures;
  std::vector<std::uint64_t> seeds{0, 1};
  std::vector<int> max_matches{1};
  double tilt_x_deg = 0.0;
  double tilt_y_deg = 0.0;
  double min_score = -1.0;
  bool has_no_target = false;
  bool draws_all = false;
};

std::vector<Lost> look_for_lost(Searcher& searcher, const Shot& shot, const Taught& taught,
                                const Trial& trial, const locate::LocateConfig& config) {
  std::vector<int> instances = trial.all.missed;
  if (config.max_matches == 1) {
    // One answer cannot miss the others: ask for the one that is easiest to see.
    instances.clear();
    const auto most =
        std::max_element(shot.truths.begin(), shot.truths.end(),
                         [](const Truth& a, const Truth& b) { return a.visible < b.visible; });
    if (most != shot.truths.end() && most->visible >= kVisibleOfTarget && !trial.first.is_coarse)
      instances.push_back(static_cast<int>(most - shot.truths.begin()));
  }
  std::vector<Lost> lost;
  for (const int i : instances) {
    if (static_cast<int>(lost.size()) == kProbesMax) break;
    const Probe found = probe(searcher, shot, taught, shot.truths[i]);
    lost.push_back({i, found, stage_of(found, taught, config)});
  }
  return lost;
}

std::string file_name(const Record& record) {
  std::string name = record.shot.scene + "-" + record.shot.part + "-" +
                     std::to_string(record.shot.seed) + "-" + record.sensor + "-x" +
                     std::to_string(record.max_matches);
  if (!record.cause.empty()) name += "-" + record.cause;
  if (!record.lost.empty()) name += "-" + record.lost.front().stage;
  return name + ".png";
}

void run_shot(const Options& options, Searcher& searcher, const Shot& shot, const Taught& taught) {
  for (const int max_matches : options.max_matches) {
    locate::LocateConfig config;
    config.max_matches = max_matches;
    config.min_score = options.min_score;
    const Trial trial = run_trial(searcher, shot, taught, config);
    Record record{shot, taught, trial, options.sensor, max_matches, !options.has_no_target,
                  {},   {},     {}};
    record.cause = max_matches == 1 || options.has_no_target
                       ? cause_of_first(trial, shot, taught.fold, !options.has_no_target)
                       : cause_of_all(trial);
    if (!record.cause.empty()) record.lost = look_for_lost(searcher, shot, taught, trial, config);
    if (!options.pictures.empty() && (options.draws_all || !record.cause.empty())) {
      record.picture = options.pictures + "/" + file_name(record);
      port::write_file_atomically(record.picture, draw_trial(shot, trial, file_name(record)));
    }
    std::printf("%s\n", json_line(record).c_str());
    std::fflush(stdout);
  }
}

void run(const Options& options) {
  ShotConfig config;
  config.scene = options.scene;
  config.scene.tilt_x_rad = options.tilt_x_deg * kRadPerDeg;
  config.scene.tilt_y_rad = options.tilt_y_deg * kRadPerDeg;
  config.sensor = sensor_named(options.sensor);
  Searcher searcher;
  std::unique_ptr<Taught> taught;
  for (config.seed = options.seeds[0]; config.seed < options.seeds[1]; ++config.seed) {
    const Shot shot = take_shot(config);
    if (!taught) taught = std::make_unique<Taught>(teach_part(shot.part, config.sensor));
    run_shot(options, searcher, shot, *taught);
  }
}

}  // namespace
}  // namespace flatpose::bench

int main(int argc, char** argv) {
  using namespace flatpose::bench;
  Options options;
  CLI::App app{"Trials on simulated scenes, one line of JSON each"};
  app.add_flag_callback(
      "--list-scenes",
      [] {
        for (const std::string& name : flatpose::sim::scene_names())
          std::printf("%s\n", name.c_str());
        throw CLI::Success();
      },
      "print the scenes that there are");
  app.add_option("--scene", options.scene.scene, "of the simulator")->required();
  app.add_option("--part", options.scene.part, "the target (the scene's own)");
  app.add_option("--seeds", options.seeds, "first and end, half-open")->delimiter(':')->expected(2);
  app.add_option("--sensor", options.sensor, "standard, noise, lost or half")
      ->check(CLI::IsMember(sensor_names()));
  app.add_option("--max-matches", options.max_matches, "one search each, e.g. 1,20")
      ->delimiter(',')
      ->check(CLI::Range(1, flatpose::locate::kMatchCountMax));
  app.add_option("--min-score", options.min_score, "instead of the part's own threshold");
  app.add_option("--tilt-x", options.tilt_x_deg, "degrees, scene tilt");
  app.add_option("--tilt-y", options.tilt_y_deg, "degrees, scene tilt");
  app.add_flag("--no-target", options.has_no_target, "the scene holds none: any match is wrong");
  app.add_option("--pictures", options.pictures, "folder for a picture of every failure");
  app.add_flag("--draw-all", options.draws_all, "of every trial");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flatpose_scenes: %s\n", error.what());
    return 3;
  }
  return 0;
}
