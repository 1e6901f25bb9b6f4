#include "flatpose/teach/surface_plane.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose::teach {
namespace {

Plane fitted(const std::vector<SurfaceSample>& samples, double tolerance_mm) {
  std::vector<double> scratch(samples.size());
  return dominant_plane(samples, tolerance_mm, scratch);
}

TEST(DominantPlane, IsExactOnAPlane) {
  const Plane truth{0.12, -0.07, 33.0};
  std::vector<SurfaceSample> samples;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x)
      samples.push_back({100.0 + x, -50.0 + y, truth.z_at(100.0 + x, -50.0 + y), 0.12, -0.07});
  const Plane plane = fitted(samples, 0.3);
  EXPECT_NEAR(plane.slope_x, truth.slope_x, 1e-9);
  EXPECT_NEAR(plane.slope_y, truth.slope_y, 1e-9);
  EXPECT_NEAR(plane.offset_mm, truth.offset_mm, 1e-6);
  EXPECT_NEAR(norm(plane.normal()), 1.0, 1e-12);
}

TEST(DominantPlane, FollowsTheLevelThatMostShare) {
  // 40 % stands 3 mm higher, one in ten is anything.
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    const Plane truth{0.1 * u(generator), 0.1 * u(generator), 20.0 * u(generator)};
    std::vector<SurfaceSample> samples;
    for (int i = 0; i < 2000; ++i) {
      const double x = 60.0 * u(generator);
      const double y = 40.0 * u(generator);
      double z = truth.z_at(x, y) + 0.1 * noise(generator);
      if (x > 12.0) z += 3.0;  // 40 % of the width
      if (i % 10 == 0) z += 15.0 * u(generator);
      samples.push_back({x, y, z, truth.slope_x + 0.03 * noise(generator),
                         truth.slope_y + 0.03 * noise(generator)});
    }
    const Plane plane = fitted(samples, 0.3);
    EXPECT_NEAR(plane.slope_x, truth.slope_x, 0.002) << seed;
    EXPECT_NEAR(plane.slope_y, truth.slope_y, 0.002) << seed;
    EXPECT_NEAR(plane.z_at(-24.0, 0.0), truth.z_at(-24.0, 0.0), 0.05) << seed;
  }
}

TEST(DominantPlane, IsNotDrawnToALevelClosely) {
  // A level that only a wide window takes in.
  const double tolerance_mm = 0.3;
  for (const double above_mm : {0.9, 1.2, 1.5}) {
    std::vector<SurfaceSample> samples;
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 50; ++x)
        samples.push_back({1.0 * x, 1.0 * y, x < 30 ? 5.0 : 5.0 + above_mm, 0, 0});
    const Plane plane = fitted(samples, tolerance_mm);
    EXPECT_NEAR(plane.z_at(15.0, 15.0), 5.0, 0.02) << above_mm;
    EXPECT_NEAR(plane.slope_x, 0.0, 0.002) << above_mm;
  }
}

TEST(DominantPlane, TakesThreeSamples) {
  const Plane plane = fitted({{0, 0, 1, 0, 0}, {10, 0, 1, 0, 0}, {0, 10, 1, 0, 0}}, 0.1);
  EXPECT_NEAR(plane.z_at(3.0, 3.0), 1.0, 1e-9);
}

}  // namespace
}  // namespace flatpose::teach
