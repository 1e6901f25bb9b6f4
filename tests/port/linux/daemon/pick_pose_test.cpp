#include "port/linux/daemon/pick_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose::daemon {
namespace {

const model::Symmetry kPlain{};
const Pose kFlip{{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, {}};

locate::Match match_at(const Pose& face_T_object) {
  locate::Match match;
  match.face_T_object = face_T_object;
  match.sigma_mm = {0.1, 0.2, 0.3};
  match.sigma_rad = {0.01, 0.02, 0.03};
  const double variances[] = {1e-4, 4e-4, 9e-4, 0.01, 0.04, 0.09};  // of the same
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j, ++at)
      match.covariance[at] = i == j ? static_cast<float>(variances[i]) : 0.0F;
  return match;
}

PickPose pick_at(double x, std::uint16_t index, std::uint16_t tool, const Rotation& more = {}) {
  PickPose pick = usual_pick();
  pick.object_T_pick = {usual_pick().object_T_pick.rotation * more, {x, 0, 0}};
  pick.index = index;
  pick.tool = tool;
  return pick;
}

TEST(PickPose, FirstInsideTheBoxIsTold) {
  const std::vector<PickPose> picks{pick_at(50, 2, 7), pick_at(0, 1, 8), pick_at(-50, 3, 9)};
  // Turned by 90 degrees about z: the object's x is the face's y.
  const locate::Match match = match_at({rotation_about_z(0.5 * kPi), {10, 20, 30}});
  ReportRule rule{PoseKind::kPick, {}};
  const Frames up_is_plus_z{};
  const auto first = report(match, kPlain, picks, rule, up_is_plus_z);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->pick, 2);
  EXPECT_EQ(first->tool, 7);
  EXPECT_NEAR(first->face_T_reported.position_mm.y, 70.0, 1e-9);
  EXPECT_NEAR(first->face_T_reported.rotation.m[8], -1.0, 1e-12);  // into the surface
  rule.limits.greatest_mm.y = 60.0;
  EXPECT_EQ(report(match, kPlain, picks, rule, up_is_plus_z)->pick, 1);
  rule.limits.greatest_mm.y = 0.0;
  EXPECT_EQ(report(match, kPlain, picks, rule, up_is_plus_z)->pick, 3);
  rule.limits.greatest_mm.y = -40.0;
  EXPECT_FALSE(report(match, kPlain, picks, rule, up_is_plus_z));
}

TEST(PickPose, TiltIsTheToolsAgainstStraightDown) {
  const double tilt_rad = 0.3;
  const Rotation leans = rotation_from_vector({tilt_rad, 0, 0});
  const std::vector<PickPose> picks{pick_at(0, 1, 1, leans), pick_at(0, 2, 1)};
  ReportRule rule{PoseKind::kPick, {}};
  rule.limits.tilt_rad = tilt_rad + 1e-6;
  EXPECT_EQ(report(match_at({}), kPlain, picks, rule, {})->pick, 1);
  rule.limits.tilt_rad = tilt_rad - 1e-6;
  EXPECT_EQ(report(match_at({}), kPlain, picks, rule, {})->pick, 2);
  // Of a part that leans as the pick leans back, the tool stands upright.
  rule.limits.tilt_rad = 1e-6;
  EXPECT_EQ(report(match_at({leans.inverse(), {}}), kPlain, picks, rule, {})->pick, 1);
  // A scan that looks down has work upside down: straight down is the face's +z.
  const Frames looks_down = frames_of_scan(false);
  EXPECT_EQ(report(match_at(kFlip), kPlain, picks, rule, looks_down)->pick, 2);
  EXPECT_FALSE(report(match_at({}), kPlain, picks, rule, looks_down));
}

TEST(PickPose, OfTheObjectIsTheMatchsOwn) {
  const Pose leaning{rotation_from_vector({0, 0.2, 0}), {1, 2, 3}};
  const std::vector<PickPose> picks{pick_at(50, 1, 7)};
  ReportRule rule{PoseKind::kObject, {}};
  const auto own = report(match_at(leaning), kPlain, picks, rule, {});
  ASSERT_TRUE(own);
  EXPECT_EQ(own->pick, 0);
  EXPECT_EQ(own->tool, 0);
  EXPECT_EQ(own->face_T_reported.rotation.m, leaning.rotation.m);
  EXPECT_NEAR(own->sigma_mm.z, std::hypot(0.3 * std::cos(0.2), 0.1 * std::sin(0.2)), 1e-7);
  EXPECT_NEAR(own->sigma_rad.z, 0.03, 1e-8);
  rule.limits.tilt_rad = 0.19;
  EXPECT_FALSE(report(match_at(leaning), kPlain, picks, rule, {}));
}

TEST(PickPose, IsLessSureOnALongLever) {
  const std::vector<PickPose> far{pick_at(100, 1, 1)};
  const auto told = report(match_at({}), kPlain, far, {PoseKind::kPick, {}}, {});
  ASSERT_TRUE(told);
  // 100 mm along x: a turn about z moves it along y, one about y along z.
  EXPECT_NEAR(told->sigma_mm.x, 0.1, 1e-6);
  EXPECT_NEAR(told->sigma_mm.y, std::hypot(0.2, 100 * 0.03), 1e-6);
  EXPECT_NEAR(told->sigma_mm.z, std::hypot(0.3, 100 * 0.02), 1e-6);
  EXPECT_NEAR(told->sigma_rad.x, 0.01, 1e-8);
}

TEST(PickPose, AxesTurnAndSigmaTurnsAlong) {
  const std::vector<PickPose> turned{pick_at(0, 1, 1, rotation_about_z(0.5 * kPi))};
  const auto told = report(match_at({rotation_about_z(0.5 * kPi), {}}), kPlain, turned,
                           {PoseKind::kPick, {}}, {});
  ASSERT_TRUE(told);
  EXPECT_NEAR(told->sigma_mm.x, 0.2, 1e-6);  // the object's y is the face's -x
  EXPECT_NEAR(told->sigma_mm.y, 0.1, 1e-6);
  EXPECT_NEAR(told->sigma_rad.x, 0.02, 1e-8);  // the pick's x is the object's -y
  EXPECT_NEAR(told->sigma_rad.y, 0.01, 1e-8);
}

TEST(PickPose, AboutAFreeAxisThereIsNoSigma) {
  locate::Match match = match_at({});
  match.turn_is_free = true;
  const std::vector<PickPose> picks{usual_pick()};
  for (const PoseKind kind : {PoseKind::kObject, PoseKind::kPick}) {
    const auto told = report(match, kPlain, picks, {kind, {}}, {});
    EXPECT_TRUE(std::isnan(told->sigma_rad.z));
    EXPECT_FALSE(std::isnan(told->sigma_rad.x));
    EXPECT_FALSE(std::isnan(told->sigma_mm.x));
  }
}

TEST(PickPose, PreferredAngleChoosesTheEquivalentByTheXThatIsTold) {
  const model::Symmetry quarter{4, 3.0, -2.0};
  const Pose face_T_object{rotation_from_vector({0.1, -0.2, 0.9}), {10, 20, 30}};
  for (const PoseKind kind : {PoseKind::kObject, PoseKind::kPick}) {
    // The pick's x is turned by 30 degrees against the object's.
    const std::vector<PickPose> picks{pick_at(25, 1, 1, rotation_about_z(30.0 * kRadPerDeg))};
    for (int wanted_deg = -180; wanted_deg <= 180; wanted_deg += 17) {
      const ReportRule rule{kind, {}, wanted_deg * kRadPerDeg};
      const auto told = report(match_at(face_T_object), quarter, picks, rule, {});
      ASSERT_TRUE(told);
      const Vec3 x = told->face_T_reported.rotation.column(0);
      const double off_rad = wrap_angle(std::atan2(x.y, x.x) - wanted_deg * kRadPerDeg);
      EXPECT_LE(std::fabs(off_rad), 46.5 * kRadPerDeg);  // half a step, and what tilt bends
      // It is the part's own equivalent: the centre of symmetry stays.
      const Pose object_T_pick = kind == PoseKind::kPick ? picks[0].object_T_pick : Pose{};
      const Pose other = told->face_T_reported * object_T_pick.inverse();
      const Vec3 moved = other * Vec3{3.0, -2.0, 0.0} - face_T_object * Vec3{3.0, -2.0, 0.0};
      EXPECT_NEAR(norm(moved), 0.0, 1e-9);
    }
  }
}

}  // namespace
}  // namespace flatpose::daemon
