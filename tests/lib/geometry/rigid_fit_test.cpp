#include "flatpose/geometry/rigid_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose {
namespace {

using Points = std::vector<Vec3>;

Points drawn(std::mt19937& random, int count, const Vec3& reach) {
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  Points points;
  for (int i = 0; i < count; ++i)
    points.push_back({300 + reach.x * within(random), -80 + reach.y * within(random),
                      600 + reach.z * within(random)});
  return points;
}

Pose drawn_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vec3 axis = normalized({normal(random), normal(random), normal(random)});
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  return {rotation_from_vector(angle(random) * axis),
          {500 * normal(random), 500 * normal(random), 500 * normal(random)}};
}

Points moved(const Pose& pose, const Points& points) {
  Points out;
  for (const Vec3& p : points) out.push_back(pose * p);
  return out;
}

double squares(const Pose& pose, const Points& from, const Points& to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 d = pose * from[i] - to[i];
    sum += dot(d, d);
  }
  return sum;
}

TEST(RigidFit, FindsAnyTransformAlsoHalfTurnsAndFromOnePlane) {
  std::mt19937 random(1);
  for (int round = 0; round < 500; ++round) {
    const Vec3 reach = round % 3 == 0 ? Vec3{100, 80, 0} : Vec3{100, 80, 60};
    const Points from = drawn(random, 3 + round % 7, reach);
    Pose pose = drawn_pose(random);
    if (round % 5 == 0) pose.rotation = Rotation{{1, 0, 0, 0, -1, 0, 0, 0, -1}};
    const auto fit = fit_rigid(from, moved(pose, from));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->rms_mm, 0.0, 1e-9);
    EXPECT_NEAR(norm(fit->to_T_from * Vec3{1, 2, 3} - pose * Vec3{1, 2, 3}), 0.0, 1e-7);
    if (round % 3 == 0) {
      EXPECT_NEAR(fit->depth_mm, 0.0, 1e-6);
    }
  }
}

TEST(RigidFit, IsTheLeastOfAllNearIt) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int round = 0; round < 50; ++round) {
    const Points from = drawn(random, 6, {100, 80, 40});
    Points to = moved(drawn_pose(random), from);
    for (Vec3& p : to) p = p + Vec3{noise(random), noise(random), noise(random)};
    const auto fit = fit_rigid(from, to);
    ASSERT_TRUE(fit);
    const double least = squares(fit->to_T_from, from, to);
    EXPECT_NEAR(fit->rms_mm, std::sqrt(least / 6), 1e-9);
    for (int i = 0; i < 200; ++i) {
      const double step = std::pow(10.0, -1 - i % 5);
      const Vec3 turn{noise(random), noise(random), noise(random)};
      const Vec3 shift{noise(random), noise(random), noise(random)};
      Pose other = fit->to_T_from;
      other.rotation = rotation_from_vector(1e-2 * step * turn) * other.rotation;
      other.position_mm = other.position_mm + step * shift;
      EXPECT_GE(squares(other, from, to), least - 1e-7);
    }
  }
}

TEST(RigidFit, IsARotationForMirroredPointsToo) {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    const Points from = drawn(random, 6, {100, 80, 60});
    Points to;
    for (const Vec3& p : from) to.push_back({-p.x, p.y, p.z});
    const auto fit = fit_rigid(from, to);
    ASSERT_TRUE(fit);
    const Rotation& r = fit->to_T_from.rotation;
    EXPECT_NEAR(dot(cross(r.column(0), r.column(1)), r.column(2)), 1.0, 1e-9);
    EXPECT_GT(fit->rms_mm, 5.0);
  }
}

TEST(RigidFit, MeasuresTheSpread) {
  const Points from{{-3, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 1}, {0, 0, -1}};
  const auto fit = fit_rigid(from, from);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->length_mm, std::sqrt(18.0 / 6), 1e-12);
  EXPECT_NEAR(fit->width_mm, std::sqrt(8.0 / 6), 1e-12);
  EXPECT_NEAR(fit->depth_mm, std::sqrt(2.0 / 6), 1e-12);
}

TEST(RigidFit, RefusesWhatHoldsNothing) {
  const Points line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {9, 9, 9}};
  EXPECT_EQ(fit_rigid(line, line).status(), Status::kTooFewPoints);
  const Points two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(fit_rigid(two, two).status(), Status::kTooFewPoints);
  EXPECT_EQ(fit_rigid(line, two).status(), Status::kShapeMismatch);
  const Points one(5);
  EXPECT_EQ(fit_rigid(one, one).status(), Status::kTooFewPoints);
  Points broken{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  broken[1].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fit_rigid(broken, two).status(), Status::kShapeMismatch);
  EXPECT_EQ(fit_rigid(broken, broken).status(), Status::kNotFinite);
}

}  // namespace
}  // namespace flatpose
