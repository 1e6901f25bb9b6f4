#include "port/linux/tool/work_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <span>
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

TEST(WorkPlane, InTheCallersMemoryItIsTheSame) {
  const Scan scan(flat, 1);
  std::vector<std::byte> memory(work_plane_bytes(scan.view().size()));
  Arena arena(memory);
  const auto a = find_work_plane(scan.view(), 1, kNoise_mm, 1.0, arena, Budget());
  const auto b = find_work_plane(scan.view(), 1, kNoise_mm, 1.0);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->work_T_scan.rotation.m, b->work_T_scan.rotation.m);
  EXPECT_EQ(arena.used_bytes(), 0U);
  Arena small(std::span<std::byte>(memory).first(memory.size() / 2));
  EXPECT_EQ(find_work_plane(scan.view(), 1, kNoise_mm, 1.0, small, Budget()).status(),
            Status::kOutOfMemory);
}

TEST(WorkPlane, IsGivenUpWhenNobodyWantsIt) {
  struct Always final : Cancel {
    [[nodiscard]] bool is_asked_for() const noexcept override { return true; }
  };
  const Scan scan(flat, 1);
  std::vector<std::byte> memory(work_plane_bytes(scan.view().size()));
  Arena arena(memory);
  const Always always;
  const StoppedClock clock;
  const Budget over({clock, callers_thread, &always}, Budget::kNoEnd);
  EXPECT_EQ(find_work_plane(scan.view(), 1, kNoise_mm, 1.0, arena, over).status(),
            Status::kStopped);
}

TEST(PlaneShift, IsWhatThePlaneWasMovedBy) {
  for (const int up_sign : {1, -1}) {
    const Scan before(flat, up_sign);
    const auto aligned = find_work_plane(before.view(), up_sign, kNoise_mm, 1.0);
    ASSERT_TRUE(aligned);
    const PlaneShift none = shift_of(*aligned, aligned->work_T_scan);
    EXPECT_NEAR(none.greatest_mm, 0.0, 1e-9);
    EXPECT_NEAR(none.tilt_rad, 0.0, 1e-6);
    EXPECT_TRUE(none.is_within(1e-6, 1e-5));

    const Scan raised([](double x, double y) { return flat(x, y) + 2.0; }, up_sign);
    const auto higher = find_work_plane(raised.view(), up_sign, kNoise_mm, 1.0);
    const PlaneShift up = shift_of(*higher, aligned->work_T_scan);
    EXPECT_NEAR(up.middle_mm, 2.0 / std::sqrt(1.0125), 0.02);  // along the normal
    EXPECT_NEAR(up.greatest_mm, up.middle_mm, 0.02);
    EXPECT_NEAR(up.tilt_rad, 0.0, 1e-3);
    EXPECT_FALSE(up.is_within(1.9, 1.0));
    EXPECT_TRUE(up.is_within(2.1, 1.0));

    // About the middle: it stays there, and rises by half the width at the sides.
    const Scan leaning([](double x, double y) { return flat(x, y) + 0.02 * (x - 29.5); }, up_sign);
    const auto tilted = find_work_plane(leaning.view(), up_sign, kNoise_mm, 1.0);
    const PlaneShift turn = shift_of(*tilted, aligned->work_T_scan);
    EXPECT_NEAR(turn.middle_mm, 0.0, 0.02);
    EXPECT_NEAR(turn.tilt_rad, 0.02, 5e-4);
    EXPECT_NEAR(turn.greatest_mm, 0.02 * 59.5, 0.05);
    EXPECT_FALSE(turn.is_within(5.0, 0.019));
    EXPECT_FALSE(turn.is_within(1.0, 0.1));
  }
}

}  // namespace
}  // namespace flatpose::tool
