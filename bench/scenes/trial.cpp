#include "bench/scenes/trial.hpp"

#include <stdexcept>
#include <utility>

#include "port/linux/clock/steady_clock.hpp"

namespace flatpose::bench {

Shot take_shot(const ShotConfig& config) {
  sim::SimulatedScan scan = sim::simulate(config.scene, config.sensor, config.seed);
  Shot shot;
  shot.scene = scan.scene;
  shot.part = scan.part;
  shot.seed = scan.seed;
  for (const sim::SimulatedInstance& instance : scan.instances) {
    if (instance.part == scan.part) {
      shot.truths.push_back({instance.scan_T_object, instance.visible});
    } else {
      shot.clutter.push_back(instance);
    }
  }
  shot.loaded = as_loaded(std::move(scan));
  return shot;
}

locate::LocateResult Searcher::locate(const Shot& shot, const model::Template& part,
                                      const locate::LocateConfig& config, VectorPath path,
                                      Executor& executor) {
  locate::Limits limits = tool::limits_for(shot.loaded.scan);
  limits.vector_path = path;
  const std::size_t size_bytes = locate::Locator::required_bytes(limits);
  if (!memory_ || memory_->size_bytes() < size_bytes)
    memory_ = std::make_unique<tool::Memory>(size_bytes);
  locate::Locator locator;
  locate::LocateResult result;
  const port::SteadyClock clock;
  Status status = locator.init(limits, memory_->span());
  if (status == Status::kOk)
    status = locator.locate(part, shot.loaded.scan.view(), shot.loaded.frames, config,
                            {clock, executor}, result);
  if (status != Status::kOk)
    throw std::runtime_error("locate '" + shot.part + "' in " + shot.loaded.path + ": " +
                             to_string(status));
  return result;
}

Trial run_trial(Searcher& searcher, const Shot& shot, const Taught& taught,
                const locate::LocateConfig& config) {
  Trial trial;
  trial.result = searcher.locate(shot, taught.part, config);
  for (const locate::Match& match : trial.result.found())
    trial.scan_T_found.push_back(match.face_T_object * taught.object_T_part);
  trial.first = judge_first(trial.scan_T_found, shot.truths, taught.fold);
  trial.all = judge_all(trial.scan_T_found, shot.truths, taught.fold, config.max_matches);
  return trial;
}

}  // namespace flatpose::bench
