#include "flatpose/model/equivalents.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose::model {
namespace {

constexpr int kOrderMax = 12;

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

/// Poses of parts on tables, tilted by up to 70 degrees, in frames that look up or down.
std::vector<Pose> made_poses() {
  std::mt19937 random(11);
  std::vector<Pose> poses;
  for (int i = 0; i < 300; ++i) {
    const double azimuth_rad = uniform(random, -kPi, kPi);
    const double tilt_rad = uniform(random, 0.0, 70.0 * kRadPerDeg);
    const Rotation tilt = rotation_from_vector(
        {tilt_rad * std::cos(azimuth_rad), tilt_rad * std::sin(azimuth_rad), 0.0});
    Rotation r = tilt * rotation_about_z(uniform(random, -kPi, kPi));
    if (i % 2 == 1) r = Rotation{{1, 0, 0, 0, -1, 0, 0, 0, -1}} * r;  // z out of the surface, down
    poses.push_back(
        {r, {uniform(random, -99, 99), uniform(random, -99, 99), uniform(random, 0, 500)}});
  }
  return poses;
}

Symmetry symmetry(int order) { return {order, 12.5, -7.0}; }

double step_rad(int order) { return 2.0 * kPi / order; }

void expect_same(const Pose& a, const Pose& b, double tolerance) {
  EXPECT_NEAR(angle_between_rad(a.rotation, b.rotation), 0.0, tolerance);
  EXPECT_NEAR(norm(a.position_mm - b.position_mm), 0.0, 100 * tolerance);
}

/// The turn by brute force: of many turns about object z the one that leaves object x nearest to
/// the face's x.
double turn_by_trial_rad(const Rotation& r) {
  double best_rad = 0.0;
  double best = -2.0;
  for (int i = 0; i < 36000; ++i) {
    const double angle_rad = 2.0 * kPi * i / 36000 - kPi;
    const double x = (r * Vec3{std::cos(angle_rad), std::sin(angle_rad), 0.0}).x;
    if (x > best) {
      best = x;
      best_rad = angle_rad;
    }
  }
  return best_rad;
}

TEST(TurnToFaceX, LaysObjectXNearestToTheFacesX) {
  const std::vector<Pose> poses = made_poses();
  for (std::size_t i = 0; i < poses.size(); i += 10) {
    const double off_rad =
        wrap_angle(turn_to_face_x_rad(poses[i].rotation) - turn_by_trial_rad(poses[i].rotation));
    EXPECT_NEAR(off_rad, 0.0, 2.0 * kPi / 36000);
  }
  EXPECT_EQ(turn_to_face_x_rad(Rotation{{0, 0, 1, 0, 1, 0, -1, 0, 0}}), 0.0)
      << "face x stands on the surface";
}

TEST(TurnedAboutSymmetry, KeepsEveryPointOfTheAxis) {
  for (const Pose& pose : made_poses()) {
    for (const double angle_rad : {0.3, -2.0, kPi}) {
      const Pose turned = turned_about_symmetry(pose, symmetry(5), angle_rad);
      for (const double z_mm : {0.0, 40.0}) {
        const Vec3 axis_mm{12.5, -7.0, z_mm};
        EXPECT_NEAR(norm(turned * axis_mm - pose * axis_mm), 0.0, 1e-11);
      }
      EXPECT_NEAR(angle_between_rad(turned.rotation, pose.rotation), std::fabs(angle_rad), 1e-12);
    }
  }
}

TEST(CanonicalEquivalent, LeavesAPartWithoutSymmetryAsItIs) {
  for (const Pose& pose : made_poses()) {
    const Pose same = canonical_equivalent(pose, symmetry(1));
    EXPECT_EQ(same.rotation.m, pose.rotation.m);
    EXPECT_EQ(same.position_mm, pose.position_mm);
  }
}

TEST(CanonicalEquivalent, IsOneOfThePosesThatLookAlikeAndOfThoseTheLeastTurned) {
  for (const Pose& pose : made_poses()) {
    for (int order = 2; order <= kOrderMax; ++order) {
      const Pose canonical = canonical_equivalent(pose, symmetry(order));
      double least_rad = 10.0;
      double nearest = 10.0;
      for (int k = 0; k < order; ++k) {
        const Pose alike = turned_about_symmetry(pose, symmetry(order), k * step_rad(order));
        least_rad = std::min(least_rad, std::fabs(turn_to_face_x_rad(alike.rotation)));
        nearest = std::min(nearest, angle_between_rad(alike.rotation, canonical.rotation) +
                                        norm(alike.position_mm - canonical.position_mm));
      }
      EXPECT_NEAR(nearest, 0.0, 1e-10);
      EXPECT_NEAR(std::fabs(turn_to_face_x_rad(canonical.rotation)), least_rad, 1e-12);
      EXPECT_LE(least_rad, 0.5 * step_rad(order) + 1e-12);
    }
  }
}

TEST(CanonicalEquivalent, IsTheSameForEveryEquivalentPoseAndForItself) {
  for (const Pose& pose : made_poses()) {
    for (int order = 2; order <= kOrderMax; ++order) {
      const Symmetry s = symmetry(order);
      const Pose canonical = canonical_equivalent(pose, s);
      // A tie between two equivalents may go either way by a rounding.
      const double turn_rad = std::fabs(turn_to_face_x_rad(canonical.rotation));
      if (turn_rad > 0.5 * step_rad(order) - 1e-9) continue;
      expect_same(canonical_equivalent(canonical, s), canonical, 1e-12);
      for (int k = 1; k < order; ++k) {
        const Pose alike = turned_about_symmetry(pose, s, k * step_rad(order));
        expect_same(canonical_equivalent(alike, s), canonical, 1e-12);
      }
    }
  }
}

TEST(CanonicalEquivalent, OfFullSymmetryHasNoTurnAtAll) {
  const Symmetry full = symmetry(kFullSymmetry);
  for (const Pose& pose : made_poses()) {
    const Pose canonical = canonical_equivalent(pose, full);
    EXPECT_NEAR(turn_to_face_x_rad(canonical.rotation), 0.0, 1e-14);
    EXPECT_NEAR(norm(canonical.rotation.column(2) - pose.rotation.column(2)), 0.0, 1e-14);
    expect_same(canonical_equivalent(canonical, full), canonical, 1e-13);
    const Pose turned = turned_about_symmetry(pose, full, 1.234);
    expect_same(canonical_equivalent(turned, full), canonical, 1e-13);
  }
}

TEST(CanonicalEquivalent, KeepsTheAxisAndTheNormalWhereTheyAre) {
  for (const Pose& pose : made_poses()) {
    for (int order = 0; order <= kOrderMax; ++order) {
      const Pose canonical = canonical_equivalent(pose, symmetry(order));
      for (const double z_mm : {0.0, 25.0}) {
        const Vec3 axis_mm{12.5, -7.0, z_mm};
        EXPECT_NEAR(norm(canonical * axis_mm - pose * axis_mm), 0.0, 1e-11);
      }
    }
  }
}

TEST(CanonicalEquivalent, BreaksATieTheSameWayEachTime) {
  for (const double angle_rad : {kPi / 2.0, -kPi / 2.0}) {  // half a step of order 2
    const Pose pose{rotation_about_z(angle_rad), {1, 2, 3}};
    const Pose once = canonical_equivalent(pose, symmetry(2));
    const Pose twice = canonical_equivalent(once, symmetry(2));
    EXPECT_NEAR(std::fabs(turn_to_face_x_rad(once.rotation)), kPi / 2.0, 1e-12);
    EXPECT_NEAR(std::fabs(turn_to_face_x_rad(twice.rotation)), kPi / 2.0, 1e-12);
  }
}

/// Of the told frame's x, in the face's xy plane, against an angle.
double off_rad(const Rotation& face_R_object, double turn_rad, const Rotation& told, double angle) {
  const Vec3 x = (face_R_object * rotation_about_z(turn_rad) * told).column(0);
  return std::fabs(std::remainder(std::atan2(x.y, x.x) - angle, 2.0 * kPi));
}

std::vector<Rotation> told_frames() {
  return {{}, Rotation{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, rotation_from_vector({2.9, 0.4, -0.7})};
}

TEST(PreferredAngle, OfNEquivalentsTheNearestByBruteForce) {
  std::mt19937 random(3);
  for (const Pose& pose : made_poses()) {
    for (const Rotation& told : told_frames()) {
      const int order = 1 + static_cast<int>(random() % kOrderMax);
      const double angle_rad = uniform(random, -kPi, kPi);
      double least = 10.0;
      for (int i = 0; i < order; ++i)
        least = std::min(least, off_rad(pose.rotation, step_rad(order) * i, told, angle_rad));
      const double turn = turn_to_angle_rad(pose.rotation, symmetry(order), told, angle_rad);
      EXPECT_NEAR(off_rad(pose.rotation, turn, told, angle_rad), least, 1e-9);
      EXPECT_NEAR(std::remainder(turn, step_rad(order)), 0.0, 1e-9);
    }
  }
}

TEST(PreferredAngle, WithFullSymmetryIsMetExactly) {
  std::mt19937 random(5);
  for (const Pose& pose : made_poses()) {
    for (const Rotation& told : {told_frames()[0], told_frames()[1]}) {
      const double angle_rad = uniform(random, -kPi, kPi);
      const double turn =
          turn_to_angle_rad(pose.rotation, symmetry(kFullSymmetry), told, angle_rad);
      EXPECT_NEAR(off_rad(pose.rotation, turn, told, angle_rad), 0.0, 1e-9);
    }
  }
}

// An x that leans more than the part cannot point everywhere: then the best of many turns.
TEST(PreferredAngle, WithFullSymmetryIsMetByAnyXThatReachesIt) {
  std::mt19937 random(6);
  int met = 0;
  for (const Pose& pose : made_poses()) {
    const Rotation told = rotation_from_vector({0.0, uniform(random, -1.2, 1.2), 0.3});
    const double angle_rad = uniform(random, -kPi, kPi);
    double least = 10.0;
    for (int i = 0; i < 3600; ++i)
      least = std::min(least, off_rad(pose.rotation, 2.0 * kPi * i / 3600, told, angle_rad));
    const double turn = turn_to_angle_rad(pose.rotation, symmetry(kFullSymmetry), told, angle_rad);
    if (least > 0.02) continue;
    EXPECT_NEAR(off_rad(pose.rotation, turn, told, angle_rad), 0.0, 1e-9);
    ++met;
  }
  EXPECT_GT(met, 150);
}

TEST(PreferredAngle, OfAPartWithoutSymmetryTurnsNothing) {
  EXPECT_EQ(turn_to_angle_rad({}, {}, {}, 1.0), 0.0);
  // Nor does an x along the axis of symmetry point anywhere.
  const Rotation upright = rotation_from_vector({0.0, -0.5 * kPi, 0.0});
  EXPECT_TRUE(std::isfinite(turn_to_angle_rad({}, {kFullSymmetry, 0, 0}, upright, 1.0)));
}

}  // namespace
}  // namespace flatpose::model
