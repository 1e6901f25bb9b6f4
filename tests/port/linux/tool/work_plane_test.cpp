#include "port/linux/tool/work_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "port/sim/random.hpp"

namespace flatpose::tool {
namespace {

constexpr int kSide = 120;
constexpr double kNoise_mm = 0.1;

// A scan of kSide x kSide points at 1 mm whose height is height(x, y) plus noise; NaN is missing.
struct Scan {
  std::vector<float> xyz_mm;

  Scan(const std::function<double(double, double)>& height_mm, int up_sign) {
    sim::Random random(7, 1);
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const double x = column - 30.0;
        const double y = row + 5.0;
        const double z = height_mm(x, y) + kNoise_mm * random.normal_pair().first;
        for (const double v : {x, y, up_sign * z}) xyz_mm.push_back(static_cast<float>(v));
      }
    }
  }
  [[nodiscard]] RangeImageView view() const {
    return {&xyz_mm[0], &xyz_mm[1], &xyz_mm[2], kSide, kSide, 12, 12 * kSide};
  }
};

double flat(double x, double y) { return 0.1 * x - 0.05 * y + 12.0; }
// 70 % of the field.
bool in_block(double x, double y) { return x > -20.0 && x < 85.0 && y > 20.0 && y < 118.0; }

TEST(WorkPlane, TiltedPlaneIsFoundAndItsFrameIsRight) {
  for (const int up_sign : {1, -1}) {
    const Scan scan(flat, up_sign);
    const auto found = find_work_plane(scan.view(), up_sign, kNoise_mm, 1.0);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->rms_mm, kNoise_mm, 0.01);
    EXPECT_GT(found->inlier_share, 0.99);
    EXPECT_NEAR(std::cos(found->tilt_rad), 1.0 / std::sqrt(1.0 + 0.01 + 0.0025), 1e-4);
    // Points of the plane have height 0 in the work frame, and what is nearer to the sensor more.
    for (const auto& [x, y] : {std::pair{0.0, 10.0}, {60.0, 100.0}}) {
      const Vec3 on{x, y, up_sign * flat(x, y)};
      EXPECT_NEAR((found->work_T_scan * on).z, 0.0, 0.02);
      EXPECT_GT((found->work_T_scan * (on + Vec3{0, 0, up_sign * 1.0})).z, 0.9);
    }
    const Pose scan_T_work = found->work_T_scan.inverse();
    EXPECT_NEAR(scan_T_work.position_mm.x, 29.5, 0.5);  // under the scan's middle
    EXPECT_NEAR(scan_T_work.position_mm.y, 64.5, 0.5);
    EXPECT_GT(scan_T_work.rotation.m[0], 0.9);          // x stays x
    EXPECT_NEAR(scan_T_work.rotation.m[3], 0.0, 0.01);  // laid onto the plane, not turned
  }
}

TEST(WorkPlane, FloorBeatsALargerTopAboveIt) {
  const Scan scan([](double x, double y) { return flat(x, y) + (in_block(x, y) ? 20.0 : 0.0); }, 1);
  const auto found = find_work_plane(scan.view(), 1, kNoise_mm, 1.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR((found->work_T_scan * Vec3{-20.0, 10.0, flat(-20.0, 10.0)}).z, 0.0, 0.05);
}

TEST(WorkPlane, FewPointsBelowDoNotCount) {
  const Scan scan([](double x, double y) { return x > 80.0 && y > 110.0 ? -30.0 : flat(x, y); }, 1);
  const auto found = find_work_plane(scan.view(), 1, kNoise_mm, 1.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR((found->work_T_scan * Vec3{0.0, 20.0, flat(0.0, 20.0)}).z, 0.0, 0.05);
}

TEST(WorkPlane, SameScanGivesTheSameBits) {
  const Scan scan([](double x, double y) { return flat(x, y) + (in_block(x, y) ? 8.0 : 0.0); }, -1);
  const auto a = find_work_plane(scan.view(), -1, kNoise_mm, 1.0);
  const auto b = find_work_plane(scan.view(), -1, kNoise_mm, 1.0);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->work_T_scan.rotation.m, b->work_T_scan.rotation.m);
  EXPECT_EQ(a->work_T_scan.position_mm, b->work_T_scan.position_mm);
}

TEST(WorkPlane, RubbleAndMissingPointsHaveNone) {
  sim::Random random(3, 2);
  const Scan rubble([&](double, double) { return random.uniform(-200.0, 200.0); }, 1);
  EXPECT_FALSE(find_work_plane(rubble.view(), 1, kNoise_mm, 1.0));
  const Scan missing([](double, double) { return std::numeric_limits<double>::quiet_NaN(); }, 1);
  EXPECT_FALSE(find_work_plane(missing.view(), 1, kNoise_mm, 1.0));
  const Scan wall([](double x, double) { return 5.0 * x; }, 1);  // 79 degrees
  EXPECT_FALSE(find_work_plane(wall.view(), 1, kNoise_mm, 1.0));
}

}  // namespace
}  // namespace flatpose::tool
