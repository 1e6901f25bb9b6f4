#include "port/sim/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "port/sim/simulate.hpp"
#include "tests/port/sim/box.hpp"

namespace flatpose::sim {
namespace {

Scene make(const char* name, std::uint64_t seed, const char* part = "") {
  SceneConfig config;
  config.scene = name;
  config.part = part;
  return make_scene(config, SensorConfig{}, seed);
}

double distance_in_plane_mm(const Instance& a, const Instance& b) {
  const Vec3 d = a.scan_T_object.position_mm - b.scan_T_object.position_mm;
  return std::hypot(d.x, d.y);
}

void expect_flat_apart_and_in_the_field(const Scene& scene) {
  const Ruler ruler{SensorConfig{}};
  for (const Instance& a : scene.instances) {
    EXPECT_EQ(a.scan_T_object.position_mm.z, a.part->thickness_mm);  // stands on the floor
    EXPECT_EQ(a.scan_T_object.rotation.column(2), (Vec3{0, 0, 1}));
    for (const Vec2 p : a.part->outline.outer) {
      EXPECT_TRUE(ruler.in_field(a.scan_T_object * Vec3{p.x, p.y, 0.0}));
    }
    for (const Instance& b : scene.instances) {
      if (&a == &b) continue;
      EXPECT_GT(distance_in_plane_mm(a, b), radius_mm(*a.part) + radius_mm(*b.part));
    }
  }
}

TEST(Scene, UnknownNameIsAnErrorThatListsTheNames) {
  try {
    (void)make("soup", 1);
    FAIL();
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("soup"), std::string::npos);
    for (const std::string& name : scene_names()) EXPECT_NE(text.find(name), std::string::npos);
  }
  EXPECT_THROW((void)make("lone", 1, "spoon"), std::invalid_argument);
}

TEST(Scene, PartsOfEverySeedAreFlatApartAndInTheField) {
  for (const char* name : {"single", "lone", "low", "cyl_loose"}) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(seed));
      expect_flat_apart_and_in_the_field(make(name, seed));
    }
  }
}

TEST(Scene, HoldsWhatItsNameSays) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_EQ(make("single", seed).instances.size(), 1u);
    EXPECT_EQ(make("empty", seed).instances.size(), 0u);
    const Scene lone = make("lone", seed);
    ASSERT_EQ(lone.instances.size(), 2u);
    for (const Instance& instance : lone.instances) EXPECT_EQ(instance.part->name, "pad");
    const Scene low = make("low", seed);
    std::multiset<std::string> names;
    for (const Instance& instance : low.instances) names.insert(instance.part->name);
    EXPECT_EQ(names.size(), 4u);
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), 4u);
    EXPECT_EQ(names.count("pad"), 1u);
    const Scene cylinders = make("cyl_loose", seed);
    EXPECT_GE(cylinders.instances.size(), 8u);
    EXPECT_EQ(cylinders.part, "cylinder");
  }
}

TEST(Scene, TakesEveryPartAsItsTarget) {
  const std::set<std::string> heaped{"medium", "high", "pile", "absent", "steep", "buried"};
  for (const std::string& part : part_names()) {
    for (const std::string& name : scene_names()) {
      if (heaped.contains(name)) continue;  // tests/whole/heap_test.cpp
      const Scene scene = make(name.c_str(), 5, part.c_str());
      EXPECT_EQ(scene.part, part);
      if (name != "empty") {
        EXPECT_EQ(scene.instances[0].part->name, part);
      }
    }
  }
}

TEST(Scene, SameSeedSamePosesOtherSeedOthers) {
  const Scene a = make("low", 8);
  const Scene b = make("low", 8);
  const Scene c = make("low", 9);
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].part->name, b.instances[i].part->name);
    EXPECT_EQ(a.instances[i].scan_T_object.position_mm, b.instances[i].scan_T_object.position_mm);
    EXPECT_EQ(a.instances[i].scan_T_object.rotation.m, b.instances[i].scan_T_object.rotation.m);
  }
  EXPECT_NE(a.instances[0].scan_T_object.position_mm, c.instances[0].scan_T_object.position_mm);
}

TEST(Scene, TurnIsTheAngleOfObjectXWhenAskedFor) {
  SceneConfig config;
  config.turn_rad = 0.5;
  const Vec3 x =
      make_scene(config, SensorConfig{}, 3).instances[0].scan_T_object.rotation.column(0);
  EXPECT_NEAR(std::atan2(x.y, x.x), 0.5, 1e-12);
}

TEST(Scene, TiltTurnsTheNormalAndTheScanShowsIt) {
  SceneConfig config;
  config.scene = "tilt";
  config.tilt_x_rad = 0.3;
  config.tilt_y_rad = -0.4;
  // R_x(a) R_y(b) z by hand: (sin b, -sin a cos b, cos a cos b).
  const Vec3 expected{std::sin(-0.4), -std::sin(0.3) * std::cos(0.4),
                      std::cos(0.3) * std::cos(0.4)};
  const SimulatedScan scan = simulate(config, exact_sensor(), 2);
  EXPECT_LT(norm(scan.instances[0].scan_T_object.rotation.column(2) - expected), 1e-12);
  const Pose object_T_scan = scan.instances[0].scan_T_object.inverse();
  const RangeImageView view = scan.view();
  const auto on_top = [&](int column, int row) {
    return std::fabs((object_T_scan * view(column, row)).z) < 1e-3;
  };
  int count = 0;
  for (int row = 0; row + 4 < view.height_px; ++row) {
    for (int column = 0; column + 4 < view.width_px; ++column) {
      if (!on_top(column, row) || !on_top(column + 4, row) || !on_top(column, row + 4)) continue;
      const Vec3 p = view(column, row);
      const Vec3 normal = normalized(cross(view(column + 4, row) - p, view(column, row + 4) - p));
      EXPECT_LT(norm(normal - expected), 1e-4);
      ++count;
    }
  }
  EXPECT_GT(count, 4000);
}

TEST(Scene, TiltUnderTheFloorIsAnError) {
  SceneConfig config;
  config.scene = "tilt";
  config.held_height_mm = 20.0;
  config.tilt_x_rad = 0.8;
  EXPECT_THROW((void)make_scene(config, SensorConfig{}, 1), std::invalid_argument);
  config.held_height_mm = std::nan("");
  EXPECT_THROW((void)make_scene(config, SensorConfig{}, 1), std::invalid_argument);
}

TEST(Scene, BinHasFourWallsThatTheScanShowsAndPartsStayInside) {
  SceneConfig config;
  config.scene = "low";
  config.bin = Bin{};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Scene scene = make_scene(config, SensorConfig{}, seed);
    EXPECT_EQ(scene.fixtures.size(), 4u);
    for (const Instance& instance : scene.instances) {
      EXPECT_LT(std::fabs(instance.scan_T_object.position_mm.x) + radius_mm(*instance.part), 280.0);
      EXPECT_LT(std::fabs(instance.scan_T_object.position_mm.y) + radius_mm(*instance.part), 230.0);
    }
  }
  const SimulatedScan shown = simulate(config, exact_sensor(), 1);
  EXPECT_EQ(shown.instances.size(), 4u);  // walls are no instances
  float highest_mm = 0.0F;
  for (std::size_t i = 2; i < shown.xyz_mm.size(); i += 3) {
    highest_mm = std::fmax(highest_mm, shown.xyz_mm[i]);
  }
  EXPECT_NEAR(highest_mm, 80.0F, 1e-3);
  config.bin->wall_mm = 0.0;
  EXPECT_THROW((void)make_scene(config, SensorConfig{}, 1), std::invalid_argument);
}

TEST(Scene, SaysSoWhenThePartsFindNoRoom) {
  SensorConfig small;
  small.field_x_mm = small.field_y_mm = 120.0;
  EXPECT_THROW((void)make_scene({}, small, 1), std::runtime_error);
}

}  // namespace
}  // namespace flatpose::sim
