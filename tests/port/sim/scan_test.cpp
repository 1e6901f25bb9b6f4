// Range images against geometry worked out by hand. Laser at (0, 0, 1300), camera at (0, 525.2,
// 1300).

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "port/sim/simulate.hpp"
#include "tests/port/sim/box.hpp"

namespace flatpose::sim {
namespace {

const double kCameraY = 1300.0 * std::tan(22.0 * kPi / 180.0);

template <class Body>
void for_each_point(const SimulatedScan& scan, Body body) {
  const RangeImageView view = scan.view();
  for (int row = 0; row < view.height_px; ++row) {
    for (int column = 0; column < view.width_px; ++column) {
      if (is_valid(view(column, row))) body(view(column, row));
    }
  }
}

/// Where the floor is seen in the middle column, beside a box at `middle`: the borders of the gap.
struct Gap {
  double from_mm;
  double to_mm;
};
Gap floor_gap(const SimulatedScan& scan, bool along_y, double middle_mm) {
  const RangeImageView view = scan.view();
  const int count = along_y ? view.height_px : view.width_px;
  Gap gap{-1e9, 1e9};
  for (int i = 0; i < count; ++i) {
    const Vec3 p = along_y ? view(view.width_px / 2, i) : view(i, view.height_px / 2);
    if (!is_valid(p) || p.z > 0.5) continue;
    const double at_mm = along_y ? p.y : p.x;
    if (at_mm < middle_mm) gap.from_mm = std::max(gap.from_mm, at_mm);
    if (at_mm > middle_mm) gap.to_mm = std::min(gap.to_mm, at_mm);
  }
  return gap;
}

TEST(Scan, EmptyFloorIsTheGridAtHeightZero) {
  const SimulatedScan scan = sim::scan(scene_of({}), exact_sensor(), 1);
  ASSERT_EQ(scan.xyz_mm.size(), 3u * 600u * 500u);
  const RangeImageView view = scan.view();
  for (int row = 0; row < 500; ++row) {
    for (int column = 0; column < 600; ++column) {
      const Vec3 p = view(column, row);
      ASSERT_NEAR(p.x, column - 299.5, 1e-4);
      ASSERT_NEAR(p.y, row - 249.5, 1e-4);
      ASSERT_NEAR(p.z, 0.0, 1e-4);
    }
  }
}

TEST(Scan, ViewpointIsTheCamera) {
  const SimulatedScan scan = sim::scan(scene_of({}), exact_sensor(), 1);
  EXPECT_NEAR(scan.viewpoint_mm.y, kCameraY, 1e-9);
  EXPECT_EQ(scan.viewpoint_mm.z, 1300.0);
}

TEST(Scan, TopOfABoxIsAtItsHeightAndOnTheLaserRay) {
  const SimulatedScan scan =
      sim::scan(scene_of({box({0, 0, 50}, 100, 100, 50)}), exact_sensor(), 1);
  const RangeImageView view = scan.view();
  // The ray to the floor at (30.5, 20.5) is met 50 / 1300 of the way earlier.
  const Vec3 p = view(330, 270);
  EXPECT_NEAR(p.x, 30.5 * 1250.0 / 1300.0, 1e-4);
  EXPECT_NEAR(p.y, 20.5 * 1250.0 / 1300.0, 1e-4);
  EXPECT_NEAR(p.z, 50.0, 1e-4);
  EXPECT_NEAR(norm(p - Vec3{0, 0, 1300}),
              std::sqrt(30.5 * 30.5 + 20.5 * 20.5 + 1300.0 * 1300.0) * 1250.0 / 1300.0, 1e-3);
}

TEST(Scan, RaisedAndRecessedAreasAreAtTheirHeights) {
  Part part{.name = "x", .outline = {}, .thickness_mm = 20.0, .areas = {}};
  part.outline.outer = rectangle({}, 120, 120);
  part.areas = {{rectangle({-30, 0}, 40, 40), 4.0}, {rectangle({30, 0}, 40, 40), -6.0}};
  const Instance instance{std::make_shared<const Part>(make_part(part)), {Rotation{}, {0, 0, 20}}};
  const SimulatedScan scan = sim::scan(scene_of({instance}), exact_sensor(), 1);
  EXPECT_NEAR(scan.view()(270, 250).z, 24.0, 1e-4);
  EXPECT_NEAR(scan.view()(330, 250).z, 14.0, 1e-4);
  EXPECT_NEAR(scan.view()(300, 290).z, 20.0, 1e-4);
}

TEST(Scan, CameraShadowFallsBehindABoxOnTheFarSide) {
  // From y = -200 to -100, 50 high. Over the edge at -200 the camera sees the floor from
  // -200 - (525.2 + 200) 50 / 1250 = -229.0 on; the laser reached it from -208 on.
  const SimulatedScan scan =
      sim::scan(scene_of({box({0, -150, 50}, 100, 100, 50)}), exact_sensor(), 1);
  const Gap gap = floor_gap(scan, true, -150);
  const double border = -200.0 - (kCameraY + 200.0) * 50.0 / 1250.0;
  EXPECT_LE(gap.from_mm, border);
  EXPECT_GT(gap.from_mm, border - 1.0);
  EXPECT_GE(gap.to_mm, -100.0);  // this side is seen and lit down to its foot
  EXPECT_LT(gap.to_mm, -99.0);
}

TEST(Scan, CameraAndLaserShadowFallOnBothSidesOfABoxBetweenThem) {
  // From y = 100 to 200: the camera's shadow lies before it, 100 - (525.2 - 100) 50 / 1250 = 83.0,
  // the laser's behind it, 200 1300 / 1250 = 208.
  const SimulatedScan scan =
      sim::scan(scene_of({box({0, 150, 50}, 100, 100, 50)}), exact_sensor(), 1);
  const Gap gap = floor_gap(scan, true, 150);
  const double camera_border = 100.0 - (kCameraY - 100.0) * 50.0 / 1250.0;
  EXPECT_LE(gap.from_mm, camera_border);
  EXPECT_GT(gap.from_mm, camera_border - 1.0);
  EXPECT_GE(gap.to_mm, 208.0 - 1e-4);
  EXPECT_LT(gap.to_mm, 209.0);
}

TEST(Scan, ShadowToTheSideIsTheSameForBoth) {
  const SimulatedScan scan =
      sim::scan(scene_of({box({200, 0, 50}, 100, 100, 50)}), exact_sensor(), 1);
  const Gap gap = floor_gap(scan, false, 200);
  EXPECT_GE(gap.to_mm, 260.0 - 1e-4);  // 250 1300 / 1250
  EXPECT_LT(gap.to_mm, 261.0);
  EXPECT_LE(gap.from_mm, 150.0);
  EXPECT_GT(gap.from_mm, 149.0);
}

TEST(Scan, WithoutNoiseEveryPointLiesOnAFace) {
  const SimulatedScan scan =
      sim::scan(scene_of({box({0, -200, 50}, 100, 100, 50)}), exact_sensor(), 1);
  int on_wall = 0;
  for_each_point(scan, [&](const Vec3& p) {
    if (std::fabs(p.z) < 1e-4 || std::fabs(p.z - 50.0) < 1e-4) return;
    EXPECT_NEAR(p.y, -150.0, 1e-4);  // the one wall that is lit and seen
    ++on_wall;
  });
  EXPECT_GT(on_wall, 100);
}

TEST(Scan, NoiseHasItsSigmasAlongBothRays) {
  SensorConfig noisy = exact_sensor();
  noisy.laser_noise_mm = 0.4;
  noisy.camera_noise_mm = 0.12;
  const SimulatedScan truth = sim::scan(scene_of({}), exact_sensor(), 1);
  const SimulatedScan scan = sim::scan(scene_of({}), noisy, 1);
  double laser2 = 0.0, camera2 = 0.0, both = 0.0, laser = 0.0, camera = 0.0;
  for (int row = 0; row < 500; ++row) {
    for (int column = 0; column < 600; ++column) {
      const Vec3 p = truth.view()(column, row);
      const Vec3 error = scan.view()(column, row) - p;
      const Vec3 a = normalized(p - Vec3{0, 0, 1300});
      const Vec3 b = normalized(p - Vec3{0, kCameraY, 1300});
      // error = s a + t b: the two normal equations.
      const double c = dot(a, b);
      const double s = (dot(error, a) - c * dot(error, b)) / (1.0 - c * c);
      const double t = (dot(error, b) - c * dot(error, a)) / (1.0 - c * c);
      ASSERT_LT(norm(error - s * a - t * b), 1e-4);
      laser += s;
      camera += t;
      laser2 += s * s;
      camera2 += t * t;
      both += s * t;
    }
  }
  const double n = 600.0 * 500.0;
  EXPECT_NEAR(std::sqrt(laser2 / n), 0.4, 0.004);
  EXPECT_NEAR(std::sqrt(camera2 / n), 0.12, 0.0012);
  EXPECT_NEAR(both / std::sqrt(laser2 * camera2), 0.0, 0.01);
  EXPECT_NEAR(laser / n, 0.0, 0.004);
  EXPECT_NEAR(camera / n, 0.0, 0.0012);
}

TEST(Scan, LosesItsShareOfThePoints) {
  for (const double share : {0.01, 0.2}) {
    SensorConfig config = exact_sensor();
    config.lost_share = share;
    int count = 0;
    for_each_point(sim::scan(scene_of({}), config, 4), [&](const Vec3&) { ++count; });
    const double n = 600.0 * 500.0;
    EXPECT_NEAR(1.0 - count / n, share, 5.0 * std::sqrt(share / n));
  }
}

TEST(Scan, MissingPointsAreNanInAllThree) {
  SensorConfig config = exact_sensor();
  config.lost_share = 0.5;
  const SimulatedScan scan = sim::scan(scene_of({box({0, 0, 50}, 100, 100, 50)}), config, 4);
  for (std::size_t i = 0; i < scan.xyz_mm.size(); i += 3) {
    const bool missing = std::isnan(scan.xyz_mm[i]);
    ASSERT_EQ(std::isnan(scan.xyz_mm[i + 1]), missing);
    ASSERT_EQ(std::isnan(scan.xyz_mm[i + 2]), missing);
  }
}

TEST(Scan, MixedPointsStandBetweenTheFacesOfAStepAndNowhereElse) {
  // Of this box no wall is both lit and seen, so a height between floor and top is a mixed point.
  const Scene scene = scene_of({box({0.3, 150.4, 50}, 100, 100, 50)});
  int counts[3] = {};
  const double shares[3] = {0.0, 0.5, 1.0};
  for (int i = 0; i < 3; ++i) {
    SensorConfig config = exact_sensor();
    config.mixed_share = shares[i];
    for_each_point(sim::scan(scene, config, 1), [&](const Vec3& p) {
      EXPECT_GT(p.z, -1e-4);
      EXPECT_LT(p.z, 50.0 + 1e-4);
      if (p.z < 0.1 || p.z > 49.9) return;
      ++counts[i];
      // Within a pixel of the outline of the top, as the laser sees it on the floor.
      const double x = std::fabs(p.x * 1300.0 / (1300.0 - p.z) - 0.312);
      const double y = std::fabs(p.y * 1300.0 / (1300.0 - p.z) - 156.416);
      EXPECT_LT(std::min(std::fabs(x - 52.0), std::fabs(y - 52.0)), 1.0);
    });
  }
  EXPECT_EQ(counts[0], 0);
  EXPECT_GT(counts[2], 150);
  EXPECT_NEAR(counts[1], 0.5 * counts[2], 0.15 * counts[2]);
}

TEST(Scan, RangeIsQuantisedAlongTheLaserRay) {
  SensorConfig config = exact_sensor();
  config.laser_noise_mm = 0.4;
  config.quantisation_mm = 0.25;
  for_each_point(sim::scan(scene_of({}), config, 1), [&](const Vec3& p) {
    const double steps = norm(p - Vec3{0, 0, 1300}) / 0.25;
    ASSERT_NEAR(steps, std::round(steps), 1e-3);
  });
}

TEST(Scan, SceneSensorAndSeedDetermineEveryBit) {
  SceneConfig scene;
  scene.scene = "low";
  SensorConfig sensor;
  sensor.columns = 300;
  sensor.rows = 250;
  const auto same = [](const SimulatedScan& a, const SimulatedScan& b) {
    return std::memcmp(a.xyz_mm.data(), b.xyz_mm.data(), a.xyz_mm.size() * sizeof(float)) == 0;
  };
  const SimulatedScan first = simulate(scene, sensor, 5);
  EXPECT_TRUE(same(first, simulate(scene, sensor, 5)));
  EXPECT_FALSE(same(first, simulate(scene, sensor, 6)));
}

TEST(Scan, BitsAreThoseOfEveryOtherMachine) {
  SensorConfig sensor;
  sensor.columns = 120;
  sensor.rows = 100;
  Instance tilted = box({20, 30, 90}, 120, 80, 30);
  tilted.scan_T_object.rotation = rotation_from_vector({0.2, -0.3, 0.5});
  const SimulatedScan scan =
      sim::scan(scene_of({tilted, box({-100, -100, 40}, 90, 90, 40)}), sensor, 42);
  std::uint64_t digest = 0xCBF29CE484222325ULL;  // FNV-1a 64
  for (const float value : scan.xyz_mm) {
    std::uint32_t bits = 0x7FC00000U;  // one NaN for all
    if (!std::isnan(value)) std::memcpy(&bits, &value, sizeof bits);
    for (int shift = 0; shift < 32; shift += 8) {
      digest = (digest ^ ((bits >> shift) & 0xFFU)) * 0x100000001B3ULL;
    }
  }
  EXPECT_EQ(digest, 7393068916110158052ULL);
}

}  // namespace
}  // namespace flatpose::sim
