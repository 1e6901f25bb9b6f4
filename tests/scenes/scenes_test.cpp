// The short form of ./run scenes: the same trials with few seeds, a test a scene and part, so that
// ctest runs them side by side. Seeds are those that weights and thresholds were tuned on.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bench/scenes/cause.hpp"
#include "bench/scenes/sensors.hpp"
#include "bench/scenes/trial.hpp"

namespace flatpose::bench {
namespace {

struct ShortCase {
  const char* scene;
  const char* part;
  const char* sensor;
  std::uint64_t first_seed;
  int seed_count;
  bool is_for_all = false;  ///< Searched for all instances too.
};

std::string name_of(const ShortCase& c) {
  return std::string(c.scene) + "_" + c.part + "_" + c.sensor;
}

class ShortScenes : public testing::TestWithParam<ShortCase> {
 protected:
  void SetUp() override {
    taught_ =
        std::make_unique<Taught>(teach_part(GetParam().part, sensor_named(GetParam().sensor)));
    EXPECT_EQ(taught_->report.scan_count_used, static_cast<int>(kTeachSeeds.size()));
  }
  [[nodiscard]] Shot shot(int i) const {
    ShotConfig config;
    config.scene.scene = GetParam().scene;
    config.scene.part = GetParam().part;
    config.sensor = sensor_named(GetParam().sensor);
    config.seed = GetParam().first_seed + i;
    return take_shot(config);
  }
  [[nodiscard]] Trial trial(const Shot& shot, int max_matches) {
    locate::LocateConfig config;
    config.max_matches = max_matches;
    return run_trial(searcher_, shot, *taught_, config);
  }

  std::unique_ptr<Taught> taught_;
  Searcher searcher_;
};

using SceneWithTarget = ShortScenes;
using SceneWithout = ShortScenes;

TEST_P(SceneWithTarget, HasARightFirstAnswer) {
  constexpr int kSeveral = 20;
  for (int i = 0; i < GetParam().seed_count; ++i) {
    const Shot scene = shot(i);
    const Trial one = trial(scene, 1);
    EXPECT_TRUE(one.first.is_coarse)
        << "seed " << scene.seed << ": " << cause_of_first(one, scene, taught_->fold, true);
    if (!GetParam().is_for_all) continue;
    const Trial all = trial(scene, kSeveral);
    EXPECT_TRUE(all.all.wrong_matches.empty() && all.all.double_matches.empty())
        << "seed " << scene.seed << ": " << cause_of_all(all);
    EXPECT_GT(all.all.wanted_count, 0);
    EXPECT_LT(static_cast<int>(all.all.missed.size()), std::max(2, all.all.wanted_count / 10))
        << "seed " << scene.seed;
  }
}

TEST_P(SceneWithout, HasNoAnswer) {
  for (int i = 0; i < GetParam().seed_count; ++i) {
    const Shot scene = shot(i);
    const Trial none = trial(scene, 1);
    EXPECT_FALSE(none.first.has_target);
    EXPECT_FALSE(none.first.has_answer)
        << "seed " << scene.seed << ": " << cause_of_first(none, scene, taught_->fold, false);
  }
}

std::string case_name(const testing::TestParamInfo<ShortCase>& info) { return name_of(info.param); }

INSTANTIATE_TEST_SUITE_P(Short, SceneWithTarget,
                         testing::Values(ShortCase{"lone", "pad", "standard", 0, 2},
                                         ShortCase{"low", "pad", "standard", 2, 2},
                                         ShortCase{"cyl_loose", "cylinder", "standard", 4, 2, true},
                                         ShortCase{"medium", "pad", "standard", 6, 2, true},
                                         ShortCase{"high", "pad", "standard", 8, 2, true},
                                         ShortCase{"pile", "pad", "standard", 10, 2, true},
                                         ShortCase{"cyl_grid", "cylinder", "standard", 12, 1, true},
                                         ShortCase{"cyl_brick", "cylinder", "standard", 14, 1,
                                                   true}),
                         case_name);

INSTANTIATE_TEST_SUITE_P(Short, SceneWithout,
                         testing::Values(ShortCase{"empty", "pad", "standard", 0, 3}), case_name);

}  // namespace
}  // namespace flatpose::bench
