// Visible shares worked out by hand. Laser at (0, 0, 1300), camera at (0, 525.2, 1300). The target
// is a square of 80 mm, its top at 10 mm; a plate 2 mm thick hangs over it, its top at 100 mm.

#include <gtest/gtest.h>

#include <cmath>

#include "port/sim/simulate.hpp"
#include "tests/port/sim/box.hpp"

namespace flatpose::sim {
namespace {

const double kCameraY = 1300.0 * std::tan(22.0 * kPi / 180.0);
constexpr double kTolerance = 0.008;  // the top is sampled on 100 x 100 points

SensorConfig quick_sensor() {
  SensorConfig config;
  config.columns = 60;  // the truth does not depend on the grid
  config.rows = 50;
  return config;
}

double visible_under(const Instance& plate) {
  const SimulatedScan scan =
      sim::scan(scene_of({box({0, 0, 10}, 80, 80, 10), plate}), quick_sensor(), 1);
  return scan.instances[0].visible;
}

TEST(Visible, IsOneForWhatLiesOpen) {
  for (const std::string name : {"pad", "washer", "strip", "cylinder"}) {
    SceneConfig scene;
    scene.part = name;
    EXPECT_EQ(simulate(scene, quick_sensor(), 1).instances[0].visible, 1.0) << name;
  }
}

TEST(Visible, IsHalfUnderAPlateThatEndsInThePlaneOfLaserAndCamera) {
  EXPECT_NEAR(visible_under(box({100, 0, 100}, 200, 300, 2)), 0.5, kTolerance);
  EXPECT_NEAR(visible_under(box({-100, 0, 100}, 200, 300, 2)), 0.5, kTolerance);
}

TEST(Visible, CountsWhatTheCameraCannotSee) {
  // The plate begins at y = 30. At its top the camera's ray from (y, 10) is at
  // y + (525.2 - y) 90 / 1290; that is beyond 30 for y > -7.1. The laser's shadow begins at 32.
  const double border = (30.0 - kCameraY * 90.0 / 1290.0) / (1.0 - 90.0 / 1290.0);
  EXPECT_NEAR(visible_under(box({0, 130, 100}, 300, 200, 2)), (border + 40.0) / 80.0, kTolerance);
}

TEST(Visible, CountsWhatTheLaserCannotReach) {
  // The plate ends at y = -10. The laser's ray from (y, 10) is at y (1 - 88 / 1290) at its bottom,
  // behind -10 for y < -10.7; the camera looks under the plate.
  const double border = -10.0 / (1.0 - 88.0 / 1290.0);
  EXPECT_NEAR(visible_under(box({0, -110, 100}, 300, 200, 2)), (40.0 - border) / 80.0, kTolerance);
}

TEST(Visible, EndsAtTheBorderOfTheField) {
  // At 10 mm the field reaches to x = 300 1290 / 1300 = 297.7.
  const SimulatedScan scan =
      sim::scan(scene_of({box({300, 0, 10}, 80, 80, 10)}), quick_sensor(), 1);
  EXPECT_NEAR(scan.instances[0].visible, (300.0 * 1290.0 / 1300.0 - 260.0) / 80.0, kTolerance);
}

TEST(Visible, IsWhatAPartLyingOnItLeavesOpen) {
  // A plate 5 thick on the half at x > 0, then on the quarter at x > 20: laser and camera look
  // down from x = 0 and see up to its foot.
  EXPECT_NEAR(visible_under(box({20, 0, 15}, 40, 80, 5)), 0.5, kTolerance);
  EXPECT_NEAR(visible_under(box({30, 0, 15}, 20, 80, 5)), 0.75, kTolerance);
  // On the half at y > 0 it hides from the camera what is nearer to it than 525.2 5 / 1285 = 2.0.
  const double hidden = kCameraY * 5.0 / 1285.0;
  EXPECT_NEAR(visible_under(box({0, 20, 15}, 80, 40, 5)), (40.0 - hidden) / 80.0, kTolerance);
  // On the half at y < 0 nothing is hidden beside it: the laser stands over its edge.
  EXPECT_NEAR(visible_under(box({0, -20, 15}, 80, 40, 5)), 0.5, kTolerance);
  // A strip of 20 across the middle, from y = -10 to 10.
  const double behind = (kCameraY + 10.0) * 5.0 / 1285.0;
  const double lit = 10.0 * 5.0 / 1285.0;  // the laser's shadow beyond y = 10, by its own angle
  EXPECT_NEAR(visible_under(box({0, 0, 15}, 80, 20, 5)), (60.0 - behind - lit) / 80.0, kTolerance);
}

TEST(Visible, IsNothingForATopThatLooksDown) {
  Instance target = box({0, 0, 10}, 80, 80, 10);
  target.scan_T_object = {rotation_from_vector({kPi, 0, 0}), {0, 0, 1}};
  EXPECT_EQ(sim::scan(scene_of({target}), quick_sensor(), 1).instances[0].visible, 0.0);
}

TEST(Visible, OwnRaisedAreasHideTheTopBehindThem) {
  // A wall 20 high from y = 0 to 10 across the whole top (at 10 mm, so up to 30 mm). The camera
  // sees the top behind it from y = 0 - 525.2 20 / 1270 = -8.3 on.
  Part part{.name = "x", .outline = {}, .thickness_mm = 10.0, .areas = {}};
  part.outline.outer = rectangle({}, 80, 80);
  part.areas = {{rectangle({0, 5}, 80, 10), 20.0}};
  const Instance target{std::make_shared<const Part>(make_part(part)), {Rotation{}, {0, 0, 10}}};
  const double hidden = kCameraY * 20.0 / 1270.0;
  EXPECT_NEAR(sim::scan(scene_of({target}), quick_sensor(), 1).instances[0].visible,
              1.0 - hidden / 80.0, 2.0 * kTolerance);
}

TEST(Visible, DoesNotDependOnSeedOrNoise) {
  const Instance plate = box({0, 130, 100}, 300, 200, 2);
  SensorConfig noisy = quick_sensor();
  noisy.laser_noise_mm = 2.0;
  noisy.lost_share = 0.5;
  const Scene scene = scene_of({box({0, 0, 10}, 80, 80, 10), plate});
  EXPECT_EQ(sim::scan(scene, noisy, 1).instances[0].visible,
            sim::scan(scene, quick_sensor(), 2).instances[0].visible);
}

}  // namespace
}  // namespace flatpose::sim
