// Heaped scenes, judged as they stand: by columns cut through them and by the truth of a scan.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "port/sim/rim.hpp"
#include "port/sim/simulate.hpp"
#include "port/sim/underside.hpp"
#include "port/sim/visible.hpp"
#include "tests/port/sim/columns.hpp"

namespace flatpose::sim {
namespace {

constexpr double kOverlapMaxMm = 0.3;
constexpr double kGapMaxMm = 0.3;

Scene make(const std::string& name, std::uint64_t seed, const std::string& part = "",
           bool in_bin = false) {
  SceneConfig config;
  config.scene = name;
  config.part = part;
  if (in_bin) config.bin = Bin{};
  return make_scene(config, SensorConfig{}, seed);
}

int count_of(const Scene& scene, const std::string& part) {
  int count = 0;
  for (const Instance& instance : scene.instances) count += instance.part->name == part;
  return count;
}

double lean_deg(const Instance& instance) {
  return arc_cosine(std::fabs(instance.scan_T_object.rotation.column(2).z)) * kDegPerRad;
}
bool upright(const Instance& instance) { return instance.scan_T_object.rotation.column(2).z > 0.0; }

double visible(const Scene& scene, const Instance& instance) {
  const World world(scene);
  const Ruler ruler{SensorConfig{}};
  return VisibleShare(world, ruler).of(instance);
}

/// Of the parts of that name with that side up, the share of the one that shows most.
double most_visible(const Scene& scene, const std::string& part, bool is_upright = true) {
  double most = 0.0;
  for (auto i = scene.instances.rbegin(); i != scene.instances.rend() && most < 0.6; ++i) {
    if (i->part->name != part || upright(*i) != is_upright) continue;
    most = std::max(most, visible(scene, is_upright ? *i : underside(*i)));
  }
  return most;
}

void expect_at_rest(const Scene& scene, double column_mm = 1.0) {
  const Columns columns(scene, column_mm);
  EXPECT_LT(columns.deepest_overlap_mm(), kOverlapMaxMm);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& body = scene.instances[i];
    const Vec3 center_mm = body.scan_T_object * center_of_mass_mm(*body.part);
    EXPECT_TRUE(columns.rests(static_cast<int>(i), center_mm, kGapMaxMm))
        << body.part->name << " " << i;
  }
}

void expect_inside(const Scene& scene, double reach_x_mm, double reach_y_mm,
                   const SensorConfig& sensor = {}) {
  const Ruler ruler{sensor};
  for (const Instance& body : scene.instances) {
    for (const Vec2 p : body.part->outline.outer) {
      for (const double z_mm : {-body.part->thickness_mm, height_max_mm(*body.part)}) {
        const Vec3 p_mm = body.scan_T_object * Vec3{p.x, p.y, z_mm};
        EXPECT_TRUE(ruler.in_field(p_mm));
        EXPECT_LE(std::fabs(p_mm.x), reach_x_mm);
        EXPECT_LE(std::fabs(p_mm.y), reach_y_mm);
      }
    }
  }
}

void expect_leans_at_most(const Scene& scene, double most_deg) {
  for (const Instance& body : scene.instances) EXPECT_LE(lean_deg(body), most_deg);
}

class HeapedScene : public testing::TestWithParam<const char*> {};

TEST_P(HeapedScene, IsAtRestWithoutOverlapInTheField) {
  const Scene scene = make(GetParam(), 17);
  expect_at_rest(scene);
  expect_inside(scene, 300.0, 250.0);
  expect_leans_at_most(scene, std::string(GetParam()) == "steep" ? 45.0 : 25.0);
}

TEST_P(HeapedScene, IsAtRestBetweenTheWallsOfABin) {
  const Scene scene = make(GetParam(), 4, "", true);
  EXPECT_EQ(scene.fixtures.size(), 4u);
  expect_at_rest(scene);
  expect_inside(scene, 280.0, 230.0);
}

TEST_P(HeapedScene, TakesOtherPartsAsItsTarget) {
  const bool absent = std::string(GetParam()) == "absent";
  for (const std::string part : {"washer", "plate", "cylinder"}) {
    const Scene scene = make(GetParam(), 3, part);
    EXPECT_EQ(scene.part, part);
    if (!absent) {
      EXPECT_EQ(scene.instances[0].part->name, part);
      EXPECT_TRUE(upright(scene.instances[0]));
    }
    if (part != "cylinder") {
      EXPECT_EQ(count_of(scene, "cylinder"), 0);
    }
  }
}

TEST_P(HeapedScene, IsTheSameForTheSameSeedOnly) {
  const Scene a = make(GetParam(), 8, "washer");
  const Scene b = make(GetParam(), 8, "washer");
  const Scene c = make(GetParam(), 9, "washer");
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].part->name, b.instances[i].part->name);
    EXPECT_EQ(a.instances[i].scan_T_object.position_mm, b.instances[i].scan_T_object.position_mm);
    EXPECT_EQ(a.instances[i].scan_T_object.rotation.m, b.instances[i].scan_T_object.rotation.m);
  }
  EXPECT_NE(a.instances[0].scan_T_object.position_mm, c.instances[0].scan_T_object.position_mm);
}

TEST_P(HeapedScene, KeepsToASmallField) {
  SceneConfig config;
  config.scene = GetParam();
  SensorConfig small;
  small.field_x_mm = 400.0;
  small.field_y_mm = 300.0;
  expect_inside(make_scene(config, small, 3), 200.0, 150.0, small);
}

TEST_P(HeapedScene, SaysSoWhenTheFieldHasNoRoom) {
  SceneConfig config;
  config.scene = GetParam();
  SensorConfig small;
  small.field_x_mm = small.field_y_mm = 70.0;
  try {
    (void)make_scene(config, small, 1);
    FAIL();
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(GetParam()), std::string::npos);
    EXPECT_NE(text.find("no room"), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(, HeapedScene,
                         testing::Values("medium", "high", "pile", "absent", "steep", "buried"),
                         [](const auto& scene) { return std::string(scene.param); });

TEST(HeapedScenes, NoPartIsHeldByItsSide) {
  // In this scene a part once hung with its leaning side on an edge, past which it would slip.
  expect_at_rest(make("absent", 64), 0.5);
}

TEST(HeapedScenes, HoldWhatTheirNamesSay) {
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    SCOPED_TRACE(seed);
    const Scene medium = make("medium", seed);
    EXPECT_EQ(medium.instances.size(), 9u);
    EXPECT_EQ(count_of(medium, "pad"), 2);
    EXPECT_GE(most_visible(medium, "pad"), 0.6);
    const Scene high = make("high", seed);
    EXPECT_GE(high.instances.size(), 20u);
    EXPECT_LE(high.instances.size(), 24u);
    EXPECT_EQ(count_of(high, "pad"), 2);
    EXPECT_GE(most_visible(high, "pad"), 0.6);
    const Scene pile = make("pile", seed);
    EXPECT_GE(count_of(pile, "pad"), 18);
    EXPECT_LE(count_of(pile, "pad"), 22);
    EXPECT_EQ(pile.instances.size(), static_cast<std::size_t>(count_of(pile, "pad")));
    EXPECT_GE(most_visible(pile, "pad"), 0.6);
  }
}

TEST(HeapedScenes, PileHasLayersAndLeans) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Scene pile = make("pile", seed);
    const World world(pile);
    const Ruler ruler{SensorConfig{}};
    VisibleShare share(world, ruler);
    int high_up = 0, leaning = 0, hidden = 0;
    for (const Instance& pad : pile.instances) {
      high_up += pad.scan_T_object.position_mm.z > 3 * 8.0;
      leaning += lean_deg(pad) > 5.0;
      hidden += share.of(pad, 500) < 0.6;
    }
    EXPECT_GE(high_up, 4) << seed;
    EXPECT_GE(leaning, 6) << seed;
    EXPECT_GE(hidden, 6) << seed;
  }
}

TEST(HeapedScenes, AbsentShowsTheOtherPadAndTheTargetOnItsFaceOnly) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = make("absent", seed);
    for (const Instance& instance : scene.instances) {
      EXPECT_EQ(upright(instance), instance.part->name != "pad");
    }
    EXPECT_EQ(count_of(scene, "pad"), 2);
    EXPECT_GE(most_visible(scene, "pad", false), 0.6);
    EXPECT_GE(count_of(scene, "lookalike"), 2);
    EXPECT_GE(most_visible(scene, "lookalike"), 0.6);
  }
  const Scene truth = make("absent", 1);
  for (const Instance& instance : truth.instances) {
    if (instance.part->name == "pad") {
      EXPECT_EQ(visible(truth, instance), 0.0);
    }
  }
}

TEST(HeapedScenes, AbsentLeavesOutWhatIsTheSameOnItsFace) {
  for (const std::string part : {"washer", "flange", "strip", "cylinder"}) {
    EXPECT_EQ(count_of(make("absent", 3, part), part), 0) << part;
  }
  EXPECT_EQ(count_of(make("absent", 3, "plate"), "plate"), 2);
}

TEST(HeapedScenes, SteepHasOneTargetThatLeansAndShows) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (const std::string part : {"pad", "strip"}) {
      SCOPED_TRACE(part + std::to_string(seed));
      const Scene scene = make("steep", seed, part);
      EXPECT_EQ(count_of(scene, part), 1);
      EXPECT_GE(scene.instances.size(), 9u);  // clutter, a stack, and the target
      EXPECT_GE(lean_deg(scene.instances[0]), 20.0);
      EXPECT_LE(lean_deg(scene.instances[0]), 45.0);
      EXPECT_GE(most_visible(scene, part), 0.6);
    }
  }
}

TEST(HeapedScenes, BuriedHasOneTargetPartlyUnderOthers) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (const std::string part : {"pad", "washer"}) {
      SCOPED_TRACE(part + std::to_string(seed));
      const Scene scene = make("buried", seed, part);
      EXPECT_EQ(count_of(scene, part), 1);
      const double share = visible(scene, scene.instances[0]);
      EXPECT_GE(share, 0.5);
      EXPECT_LE(share, 0.8);
    }
  }
}

}  // namespace
}  // namespace flatpose::sim
