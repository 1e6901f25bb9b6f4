#include "flatpose/geometry/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose {
namespace {

void expect_near(const Rotation& a, const Rotation& b, double tolerance) {
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(a.m[i], b.m[i], tolerance) << "element " << i;
}

TEST(Pose, InverseAndProductCancel) {
  const Pose a{rotation_from_vector({0.3, -1.2, 0.5}), {1, 2, 3}};
  const Pose b{rotation_from_vector({-2.0, 0.1, 0.7}), {-4, 5, 0.5}};
  const Vec3 p{7, -8, 9};
  const Vec3 q = (a * b).inverse() * (a * (b * p));
  EXPECT_NEAR(norm(q - p), 0.0, 1e-12);
}

TEST(TiltRotation, TakesZToTheNormalWithoutTurning) {
  for (const Vec3& direction : {Vec3{0.1, 0.2, 1}, Vec3{-0.7, 0.3, 1}, Vec3{0, 0, 1}}) {
    const Vec3 n = normalized(direction);
    const Rotation r = tilt_rotation(n);
    EXPECT_NEAR(norm(r * Vec3{0, 0, 1} - n), 0.0, 1e-14);
    expect_near(r * r.inverse(), Rotation{}, 1e-14);
    EXPECT_NEAR(r.m[1], r.m[3], 1e-14);  // symmetric in xy: no turn about z
  }
}

TEST(RotationFromVector, IsTheAngleAndAxis) {
  const Vec3 v{0.2, -0.4, 1.1};
  const Rotation r = rotation_from_vector(v);
  EXPECT_NEAR(norm(r * v - v), 0.0, 1e-14);
  EXPECT_NEAR(angle_between_rad(r, Rotation{}), norm(v), 1e-14);
  EXPECT_NEAR(angle_between_rad(rotation_from_vector({0, 0, 1e-7}), Rotation{}), 1e-7, 1e-15);
}

TEST(Quaternion, GivesTheRotationBackWithWNotNegative) {
  for (int i = 0; i < 200; ++i) {
    const Rotation r = rotation_from_vector({0.37 * i, 2.0 - 0.11 * i, 0.05 * i});
    const Quaternion q = quaternion(r);
    EXPECT_GE(q.w, 0.0);
    const Vec3 u{q.x, q.y, q.z};
    const Vec3 p{1, -2, 3};
    const Vec3 turned = p + 2.0 * cross(u, cross(u, p) + q.w * p);
    EXPECT_NEAR(norm(turned - r * p), 0.0, 1e-12);
  }
}

TEST(RotationFromZAndX, ProjectsXOntoThePlane) {
  const Vec3 z = normalized({0.2, 0.1, 1});
  const Rotation r = rotation_from_z_and_x(z, {1, 0, 0});
  EXPECT_NEAR(norm(r.column(2) - z), 0.0, 1e-15);
  EXPECT_GT(r.column(0).x, 0.9);
  expect_near(r * r.inverse(), Rotation{}, 1e-14);
}

}  // namespace
}  // namespace flatpose
