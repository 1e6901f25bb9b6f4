// The short form of ./run scenes: the same trials with few seeds, a test a scene and part, so that
// ctest runs them side by side. Seeds are those that weights and thresholds were tuned on.

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "bench/scenes/cause.hpp"
#include "bench/scenes/sensors.hpp"
#include "bench/scenes/trial.hpp"

namespace flatpose::bench {
namespace {

struct ShortCase {
  std::string name;
  std::string part;
  std::string sensor;
  std::vector<std::string> scenes;
  std::uint64_t first_seed = 0;
  int seed_count = 1;
  int max_matches = 1;  ///< More than one: searched for all instances too.
};

void PrintTo(const ShortCase& c, std::ostream* out) { *out << c.name; }

class ShortScenes : public testing::TestWithParam<ShortCase> {
 protected:
  void SetUp() override {
    taught_ =
        std::make_unique<Taught>(teach_part(GetParam().part, sensor_named(GetParam().sensor)));
    EXPECT_EQ(taught_->report.scan_count_used, static_cast<int>(kTeachSeeds.size()));
  }
  /// Every shot of the case, one after the other.
  template <typename Check>
  void for_each_shot(const Check& check) {
    for (const std::string& scene : GetParam().scenes) {
      for (int i = 0; i < GetParam().seed_count; ++i) {
        ShotConfig config;
        config.scene.scene = scene;
        config.scene.part = GetParam().part;
        config.sensor = sensor_named(GetParam().sensor);
        config.seed = GetParam().first_seed + i;
        check(take_shot(config));
      }
    }
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
  for_each_shot([this](const Shot& shot) {
    const Trial one = trial(shot, 1);
    EXPECT_TRUE(one.first.is_coarse)
        << shot.loaded.path << ": " << cause_of_first(one, shot, taught_->fold, true);
    if (GetParam().max_matches == 1) return;
    const Trial all = trial(shot, GetParam().max_matches);
    EXPECT_TRUE(all.all.wrong_matches.empty() && all.all.double_matches.empty())
        << shot.loaded.path << ": " << cause_of_all(all);
    EXPECT_GT(all.all.wanted_count, 0) << shot.loaded.path;
    // One of few may be missed here; shares are for the whole evaluation.
    EXPECT_GE(all.all.found_count, all.all.wanted_count - 1) << shot.loaded.path;
  });
}

TEST_P(SceneWithout, HasNoAnswer) {
  for_each_shot([this](const Shot& shot) {
    const Trial none = trial(shot, 1);
    EXPECT_FALSE(none.first.has_target);
    EXPECT_FALSE(none.first.has_answer)
        << shot.loaded.path << ": " << cause_of_first(none, shot, taught_->fold, false);
  });
}

std::string case_name(const testing::TestParamInfo<ShortCase>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Short, SceneWithTarget,
    testing::Values(ShortCase{"lone_low", "pad", "standard", {"lone", "low"}, 0, 1},
                    ShortCase{"medium", "pad", "standard", {"medium"}, 10, 3, 20},
                    ShortCase{"high", "pad", "standard", {"high"}, 20, 3, 20},
                    ShortCase{"pile", "pad", "standard", {"pile"}, 30, 2, 20},
                    ShortCase{"steep", "pad", "standard", {"steep"}, 40, 3},
                    ShortCase{"buried", "pad", "standard", {"buried"}, 50, 3},
                    ShortCase{"cyl_loose", "cylinder", "standard", {"cyl_loose"}, 60, 1, 20},
                    ShortCase{"cyl_grid", "cylinder", "standard", {"cyl_grid"}, 60, 1, 64},
                    ShortCase{"cyl_brick", "cylinder", "standard", {"cyl_brick"}, 60, 1, 64}),
    case_name);

const std::vector<std::string> kOtherScenes{"medium", "high", "buried"};

INSTANTIATE_TEST_SUITE_P(
    OtherParts, SceneWithTarget,
    testing::Values(ShortCase{"bracket", "bracket", "standard", kOtherScenes, 70},
                    ShortCase{"flange", "flange", "standard", kOtherScenes, 71},
                    ShortCase{"washer", "washer", "standard", kOtherScenes, 72},
                    ShortCase{"strip", "strip", "standard", kOtherScenes, 73},
                    ShortCase{"triangle", "triangle", "standard", kOtherScenes, 74},
                    ShortCase{"plate", "plate", "standard", kOtherScenes, 75}),
    case_name);

INSTANTIATE_TEST_SUITE_P(WorseSensors, SceneWithTarget,
                         testing::Values(ShortCase{"noise", "pad", "noise", {"medium", "high"}, 80},
                                         ShortCase{"lost", "pad", "lost", {"medium", "high"}, 81},
                                         ShortCase{"half", "pad", "half", {"medium", "high"}, 82}),
                         case_name);

INSTANTIATE_TEST_SUITE_P(Short, SceneWithout,
                         testing::Values(ShortCase{"absent", "pad", "standard", {"absent"}, 90, 5},
                                         ShortCase{"empty", "pad", "standard", {"empty"}, 95, 5}),
                         case_name);

// The judge sees what the locator answers: with another truth the same answer is wrong.
TEST(Trial, IsJudgedAgainstTheTruth) {
  ShotConfig config;
  config.scene.part = "bracket";
  Shot shot = take_shot(config);
  const Taught taught = teach_part("bracket", config.sensor);
  Searcher searcher;
  EXPECT_TRUE(run_trial(searcher, shot, taught, {}).first.is_fine);
  Pose& truth = shot.truths.front().scan_T_part;
  truth = truth * Pose{Rotation{}, {0.0, 6.0, 0.0}};
  const Trial beside = run_trial(searcher, shot, taught, {});
  EXPECT_FALSE(beside.first.is_coarse);
  EXPECT_NEAR(beside.first.nearest.error.position_mm, 6.0, 0.5);
  EXPECT_EQ(beside.all.wrong_matches.size(), 1U);
}

}  // namespace
}  // namespace flatpose::bench
