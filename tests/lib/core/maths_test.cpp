#include "flatpose/core/maths.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flatpose {
namespace {

TEST(SinCos, EqualsLibmOverManyTurns) {
  for (int i = -200000; i <= 200000; ++i) {
    const double angle_rad = i * 1.7e-4;
    const auto [s, c] = sin_cos(angle_rad);
    ASSERT_NEAR(s, std::sin(angle_rad), 2e-15) << angle_rad;
    ASSERT_NEAR(c, std::cos(angle_rad), 2e-15) << angle_rad;
  }
}

TEST(SinCos, IsNanWhereTheReductionWouldLoseItsDigits) {
  EXPECT_TRUE(std::isnan(sin_cos(1e7).sin));
  EXPECT_TRUE(std::isnan(sin_cos(NAN).cos));
}

TEST(ArcTangent, EqualsLibmAllAround) {
  for (int i = -100000; i <= 100000; ++i) {
    const double angle_rad = i * kPi / 100000.0;
    for (const double radius : {1e-12, 1.0, 3e8}) {
      const double y = radius * std::sin(angle_rad);
      const double x = radius * std::cos(angle_rad);
      ASSERT_NEAR(arc_tangent(y, x), std::atan2(y, x), 2e-15) << angle_rad;
    }
  }
  EXPECT_EQ(arc_tangent(0.0, 0.0), 0.0);
}

TEST(ArcCosine, ClampsAndEqualsLibm) {
  EXPECT_EQ(arc_cosine(1.5), 0.0);
  EXPECT_NEAR(arc_cosine(-1.5), kPi, 1e-15);
  for (int i = -1000; i <= 1000; ++i)
    EXPECT_NEAR(arc_cosine(i / 1000.0), std::acos(i / 1000.0), 4e-15);
}

TEST(WrapAngle, KeepsTheAngleAndItsRange) {
  for (int i = -5000; i <= 5000; ++i) {
    const double angle_rad = i * 0.01;
    const double wrapped_rad = wrap_angle(angle_rad);
    EXPECT_GE(wrapped_rad, -kPi);
    EXPECT_LT(wrapped_rad, kPi);
    EXPECT_NEAR(std::sin(wrapped_rad), std::sin(angle_rad), 1e-12);
  }
}

}  // namespace
}  // namespace flatpose
