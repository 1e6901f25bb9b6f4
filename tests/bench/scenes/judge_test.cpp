#include "bench/scenes/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "port/sim/random.hpp"

namespace flatpose::bench {
namespace {

Rotation turn(double angle_deg) { return rotation_about_z(angle_deg * kRadPerDeg); }
Rotation lean(double angle_deg, const Vec3& axis = {1.0, 0.0, 0.0}) {
  return rotation_from_vector((angle_deg * kRadPerDeg) * axis);
}

/// Somewhere in the field, leaning.
Pose some_pose() { return {lean(25.0, {0.6, -0.8, 0.0}) * turn(130.0), {120.0, -80.0, 30.0}}; }

/// `pose` displaced in its own frame.
Pose displaced(const Pose& pose, const Rotation& rotation, const Vec3& position_mm = {}) {
  return pose * Pose{rotation, position_mm};
}

TEST(PoseError, IsNoughtForTheTruthItself) {
  const PoseError e = pose_error(some_pose(), some_pose(), 1);
  EXPECT_NEAR(e.position_mm, 0.0, 1e-12);
  EXPECT_NEAR(e.tilt_deg, 0.0, 1e-6);
  EXPECT_NEAR(e.turn_deg, 0.0, 1e-6);
}

TEST(PoseError, TellsPlaneFromHeight) {
  const PoseError e = pose_error(displaced(some_pose(), {}, {3.0, -4.0, 12.0}), some_pose(), 1);
  EXPECT_NEAR(e.in_plane_mm, 5.0, 1e-9);
  EXPECT_NEAR(e.z_mm, 12.0, 1e-9);
  EXPECT_NEAR(e.position_mm, 13.0, 1e-9);
  EXPECT_NEAR(e.tilt_deg, 0.0, 1e-6);
}

TEST(PoseError, TellsTiltFromTurn) {
  for (const double tilt_deg : {0.5, 9.0, 60.0}) {
    for (const double turn_deg : {-170.0, -20.0, 0.0, 4.0, 179.0}) {
      const PoseError e =
          pose_error(displaced(some_pose(), lean(tilt_deg, {0.28, 0.96, 0.0}) * turn(turn_deg)),
                     some_pose(), 1);
      EXPECT_NEAR(e.tilt_deg, tilt_deg, 1e-6);
      EXPECT_NEAR(e.turn_deg, std::fabs(turn_deg), 1e-6);
    }
  }
}

TEST(PoseError, SeesAPartOnItsFace) {
  EXPECT_NEAR(pose_error(displaced(some_pose(), lean(180.0)), some_pose(), 0).tilt_deg, 180.0,
              1e-5);
}

TEST(PoseError, LeavesOutTurnsOfTheSymmetry) {
  const auto turn_error = [](double turn_deg, int fold) {
    return pose_error(displaced(some_pose(), turn(turn_deg)), some_pose(), fold).turn_deg;
  };
  EXPECT_NEAR(turn_error(180.0, 1), 180.0, 1e-6);
  EXPECT_NEAR(turn_error(180.0, 2), 0.0, 1e-6);
  EXPECT_NEAR(turn_error(90.0, 2), 90.0, 1e-6);
  EXPECT_NEAR(turn_error(90.0, 4), 0.0, 1e-6);
  EXPECT_NEAR(turn_error(-93.0, 4), 3.0, 1e-6);
  EXPECT_NEAR(turn_error(118.0, 3), 2.0, 1e-6);
  EXPECT_NEAR(turn_error(77.7, 0), 0.0, 1e-6);
}

// The symmetry leaves the part as it is: the best of all equivalent truths is the error.
TEST(PoseError, EqualsTheLeastOverAllEquivalentTruths) {
  sim::Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Pose found =
        displaced(some_pose(), lean(random.uniform(0.0, 30.0)) * turn(random.uniform(-180, 180)));
    for (const int fold : {1, 2, 3, 4, 6}) {
      double least_deg = 360.0;
      for (int k = 0; k < fold; ++k) {
        const Pose equivalent = displaced(some_pose(), turn(360.0 * k / fold));
        least_deg = std::min(least_deg, pose_error(found, equivalent, 1).turn_deg);
      }
      EXPECT_NEAR(pose_error(found, some_pose(), fold).turn_deg, least_deg, 1e-6);
    }
  }
}

TEST(Bounds, HoldEachErrorByItself) {
  EXPECT_TRUE(is_within({.position_mm = 4.99, .tilt_deg = 9.99, .turn_deg = 4.99}, kCoarse));
  EXPECT_FALSE(is_within({.position_mm = 5.01}, kCoarse));
  EXPECT_FALSE(is_within({.tilt_deg = 10.01}, kCoarse));
  EXPECT_FALSE(is_within({.turn_deg = 5.01}, kCoarse));
  EXPECT_TRUE(is_within({.position_mm = 0.99, .tilt_deg = 0.99, .turn_deg = 0.99}, kFine));
  EXPECT_FALSE(is_within({.position_mm = 1.01}, kFine));
  EXPECT_FALSE(is_within({.tilt_deg = 1.01}, kFine));
  EXPECT_FALSE(is_within({.turn_deg = 1.01}, kFine));
}

constexpr int kMany = 20;

/// Three apart; the last is mostly covered.
std::vector<Truth> three() {
  return {{{turn(10.0), {-150.0, 0.0, 8.0}}, 1.0},
          {{lean(12.0) * turn(80.0), {0.0, 60.0, 20.0}}, 0.7},
          {{turn(-60.0), {150.0, -40.0, 8.0}}, 0.3}};
}

TEST(FirstAnswer, IsRightOnAnyInstanceThatIsHalfVisible) {
  for (const int i : {0, 1}) {
    const std::vector<Pose> found{displaced(three()[i].scan_T_part, turn(3.0), {2.0, 2.0, 0.0})};
    const FirstVerdict verdict = judge_first(found, three(), 1);
    EXPECT_TRUE(verdict.has_target);
    EXPECT_TRUE(verdict.has_answer);
    EXPECT_TRUE(verdict.is_coarse);
    EXPECT_FALSE(verdict.is_fine);
    EXPECT_EQ(verdict.nearest.instance, i);
    EXPECT_NEAR(verdict.nearest.error.turn_deg, 3.0, 1e-6);
  }
}

TEST(FirstAnswer, IsFineWithinTheFineBounds) {
  const std::vector<Pose> found{
      displaced(three()[1].scan_T_part, lean(0.5) * turn(0.5), {0.5, 0.0, 0.5})};
  EXPECT_TRUE(judge_first(found, three(), 1).is_fine);
}

TEST(FirstAnswer, IsNotRightOnAHiddenInstance) {
  const FirstVerdict verdict = judge_first(std::vector{three()[2].scan_T_part}, three(), 1);
  EXPECT_TRUE(verdict.has_answer);
  EXPECT_EQ(verdict.nearest.instance, 2);
  EXPECT_FALSE(verdict.is_coarse);
  EXPECT_FALSE(verdict.is_fine);
}

TEST(FirstAnswer, IsNotRightFlippedTiltedOrBesideThePart) {
  const Pose truth = three()[0].scan_T_part;
  for (const Pose& found : {displaced(truth, turn(180.0)), displaced(truth, lean(180.0)),
                            displaced(truth, lean(11.0)), displaced(truth, {}, {0.0, 6.0, 0.0}),
                            displaced(truth, {}, {0.0, 0.0, 6.0}), displaced(truth, turn(6.0))})
    EXPECT_FALSE(judge_first(std::vector{found}, three(), 1).is_coarse);
  EXPECT_TRUE(judge_first(std::vector{displaced(truth, turn(180.0))}, three(), 2).is_fine);
}

TEST(FirstAnswer, OnlyTheFirstMatchCounts) {
  const std::vector<Pose> found{displaced(three()[0].scan_T_part, turn(90.0)),
                                three()[1].scan_T_part};
  EXPECT_FALSE(judge_first(found, three(), 1).is_coarse);
}

TEST(FirstAnswer, MayBeMissingAndSoMayTheTarget) {
  const FirstVerdict silent = judge_first({}, three(), 1);
  EXPECT_TRUE(silent.has_target);
  EXPECT_FALSE(silent.has_answer);
  EXPECT_FALSE(silent.is_coarse);
  const std::vector<Truth> hidden{three()[2]};
  EXPECT_FALSE(judge_first({}, hidden, 1).has_target);
  const FirstVerdict alarm = judge_first(std::vector{some_pose()}, {}, 1);
  EXPECT_FALSE(alarm.has_target);
  EXPECT_TRUE(alarm.has_answer);
  EXPECT_FALSE(alarm.is_coarse);
}

TEST(AllAnswers, AreRightWhenEachWantedInstanceIsFoundOnce) {
  const AllVerdict verdict =
      judge_all(std::vector{three()[1].scan_T_part, three()[0].scan_T_part}, three(), 1, kMany);
  EXPECT_EQ(verdict.wanted_count, 2);
  EXPECT_TRUE(verdict.missed.empty());
  EXPECT_TRUE(verdict.wrong_matches.empty());
  EXPECT_TRUE(verdict.double_matches.empty());
}

TEST(AllAnswers, CannotBeMoreThanWereAskedFor) {
  const std::vector<Pose> one{three()[1].scan_T_part};
  EXPECT_EQ(judge_all(one, three(), 1, 1).wanted_count, 1);
  EXPECT_EQ(judge_all(one, three(), 1, 1).found_count, 1);
  EXPECT_TRUE(judge_all(one, three(), 1, 1).missed.empty());
  EXPECT_EQ(judge_all(one, three(), 1, 2).wanted_count, 2);
  EXPECT_EQ(judge_all(one, three(), 1, 2).missed, (std::vector{0}));
  // What is hardly visible does not stand in for what is.
  EXPECT_EQ(judge_all(std::vector{three()[2].scan_T_part}, three(), 1, 1).found_count, 0);
  EXPECT_EQ(judge_all(std::vector{three()[2].scan_T_part}, three(), 1, 1).missed.size(), 2U);
}

TEST(AllAnswers, MayHoldWhatIsHardlyVisible) {
  const AllVerdict verdict = judge_all(std::vector{three()[2].scan_T_part}, three(), 1, kMany);
  EXPECT_TRUE(verdict.wrong_matches.empty());
  EXPECT_EQ(verdict.missed, (std::vector{0, 1}));
}

TEST(AllAnswers, AreWrongWhereNoInstanceLies) {
  const std::vector<Pose> found{three()[0].scan_T_part,
                                displaced(three()[1].scan_T_part, turn(180.0)),
                                displaced(three()[0].scan_T_part, {}, {0.0, 40.0, 0.0})};
  const AllVerdict verdict = judge_all(found, three(), 1, kMany);
  EXPECT_EQ(verdict.wrong_matches, (std::vector{1, 2}));
  EXPECT_EQ(verdict.missed, (std::vector{1}));
  EXPECT_TRUE(judge_all(found, three(), 2, kMany).missed.empty());
  EXPECT_EQ(judge_all(found, {}, 1, kMany).wrong_matches, (std::vector{0, 1, 2}));
}

TEST(AllAnswers, AreDoubleOnTheSameInstance) {
  const Pose truth = three()[0].scan_T_part;
  const std::vector<Pose> found{truth, displaced(truth, turn(4.0)), three()[1].scan_T_part,
                                displaced(truth, {}, {4.0, 0.0, 0.0})};
  const AllVerdict verdict = judge_all(found, three(), 1, kMany);
  EXPECT_EQ(verdict.double_matches, (std::vector{1, 3}));
  EXPECT_TRUE(verdict.wrong_matches.empty());
  EXPECT_TRUE(verdict.missed.empty());
  // An equivalent pose of a symmetric part is the same place again.
  EXPECT_EQ(
      judge_all(std::vector{truth, displaced(truth, turn(90.0))}, three(), 4, kMany).double_matches,
      (std::vector{1}));
}

}  // namespace
}  // namespace flatpose::bench
