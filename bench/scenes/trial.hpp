#pragma once
// One trial: a scene is scanned in memory, the part looked for as `flatpose locate` would, and the
// matches are held against the truth. A shot may be searched several times.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/scenes/judge.hpp"
#include "bench/scenes/lesson.hpp"
#include "flatpose/locate/locator.hpp"
#include "port/linux/cpu/vector_path.hpp"
#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/sim/simulate.hpp"

namespace flatpose::bench {

struct ShotConfig {
  sim::SceneConfig scene;  ///< Its part is the target.
  sim::SensorConfig sensor;
  std::uint64_t seed = 0;
};

/// A scan with what is known of it.
struct Shot {
  tool::LoadedScan loaded;
  std::string scene;
  std::string part;
  std::uint64_t seed = 0;
  std::vector<Truth> truths;                    ///< Of the target.
  std::vector<sim::SimulatedInstance> clutter;  ///< Other parts.
};

/// Fails: as sim::simulate().
[[nodiscard]] Shot take_shot(const ShotConfig& config);

/// Searches shots, in memory that is kept from one to the next.
class Searcher {
 public:
  /// Fails: std::runtime_error when locate() refuses.
  [[nodiscard]] locate::LocateResult locate(const Shot& shot, const model::Template& part,
                                            const locate::LocateConfig& config,
                                            VectorPath path = port::best_vector_path(),
                                            Executor& executor = callers_thread);

 private:
  std::unique_ptr<tool::Memory> memory_;
};

struct Trial {
  locate::LocateResult result;
  std::vector<Pose> scan_T_found;  ///< The matches, in the simulator's part frame.
  FirstVerdict first;
  AllVerdict all;
};

/// Fails: std::runtime_error when locate() refuses.
[[nodiscard]] Trial run_trial(Searcher& searcher, const Shot& shot, const Taught& taught,
                              const locate::LocateConfig& config);

}  // namespace flatpose::bench
