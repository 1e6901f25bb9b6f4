#include "port/sim/outline.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "flatpose/core/maths.hpp"
#include "port/sim/part.hpp"
#include "port/sim/random.hpp"

namespace flatpose::sim {
namespace {

/// Oracle: the turns a loop makes about a point, from the angles its edges span.
double winding(const Loop& loop, Vec2 p) {
  double angle = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i] - p;
    const Vec2 b = loop[(i + 1) % loop.size()] - p;
    angle += std::atan2(cross(a, b), a.x * b.x + a.y * b.y);
  }
  return angle / (2.0 * kPi);
}

TEST(Outline, ContainsEqualsTheWindingNumber) {
  Random random(1);
  for (const std::string& name : part_names()) {
    const Part part = catalogue_part(name);
    for (int i = 0; i < 400; ++i) {
      const Vec2 p{random.uniform(-80, 80), random.uniform(-60, 60)};
      bool inside = winding(part.outline.outer, p) > 0.5;
      EXPECT_EQ(contains(part.outline.outer, p), inside);
      for (const Loop& hole : part.outline.holes) inside = inside && winding(hole, p) < 0.5;
      EXPECT_EQ(contains(part, p), inside) << name << " " << p.x << " " << p.y;
    }
  }
}

TEST(Outline, EveryPointOfTheBorderBelongsToOneSideOnly) {
  // Two squares that share an edge tile the plane: no point is in both or in none.
  const Loop left = rectangle({-5, 0}, 10, 10);
  const Loop right = rectangle({5, 0}, 10, 10);
  for (int i = 0; i < 10; ++i) {
    const Vec2 p{0.0, -5.0 + i};
    EXPECT_NE(contains(left, p), contains(right, p)) << p.y;
  }
}

TEST(Outline, CircleKeepsTheChordError) {
  for (const double radius : {0.5, 5.0, 32.0, 130.0}) {
    const Loop loop = circle({3, -2}, radius);
    EXPECT_EQ(loop.size() % 12, 0u);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 middle = 0.5 * (loop[i] + loop[(i + 1) % loop.size()]) - Vec2{3, -2};
      EXPECT_GE(std::hypot(middle.x, middle.y), radius - kChordErrorMm);
    }
    EXPECT_NEAR(length_mm(loop), 2.0 * kPi * radius, 0.005 * radius + 0.05);
    EXPECT_NEAR(signed_area_mm2(loop), kPi * radius * radius, 2.0 * kPi * radius * kChordErrorMm);
  }
}

TEST(Outline, RoundedRectangleHasTheAreaAndLengthOfTheFormula) {
  const Loop loop = rectangle({7, 9}, 100, 60, 10);
  EXPECT_NEAR(signed_area_mm2(loop), 6000.0 - (4.0 - kPi) * 100.0, 0.7);
  EXPECT_NEAR(length_mm(loop), 2.0 * (80.0 + 40.0) + 20.0 * kPi, 0.1);
  EXPECT_NEAR(centroid_mm({loop, {}}).x, 7.0, 1e-9);
  EXPECT_NEAR(centroid_mm({loop, {}}).y, 9.0, 1e-9);
}

TEST(Outline, RoundingTakesFromConvexCornersAndFillsConcaveOnes) {
  const Vec2 corners[] = {{0, 0}, {60, 0}, {60, 20}, {20, 20}, {20, 60}, {0, 60}};
  const Loop loop = rounded_polygon(corners, 5.0);
  const double corner = (1.0 - kPi / 4.0) * 25.0;  // between a right angle and its arc
  EXPECT_NEAR(signed_area_mm2(loop), 60 * 20 + 20 * 40 - 5 * corner + corner, 0.6);
  EXPECT_TRUE(contains(loop, {20.5, 20.5}));  // the filled inner corner
  EXPECT_FALSE(contains(loop, {0.5, 0.5}));
}

TEST(Outline, AnnularSectorHasTheAreaOfTheFormula) {
  const Loop loop =
      annular_sector({.inner_radius_mm = 40, .outer_radius_mm = 90, .half_angle_rad = 0.6});
  EXPECT_NEAR(signed_area_mm2(loop), 0.6 * (90.0 * 90.0 - 40.0 * 40.0), 1.5);
  EXPECT_TRUE(contains(loop, on_ring(60, 0.59)));
  EXPECT_FALSE(contains(loop, on_ring(60, 0.61)));
  EXPECT_FALSE(contains(loop, on_ring(39.9, 0.0)));
}

TEST(Outline, HolesCountInAreaCentroidAndLength) {
  const Outline outline{rectangle({}, 40, 20), {rectangle({10, 0}, 10, 10)}};
  EXPECT_DOUBLE_EQ(area_mm2(outline), 700.0);
  EXPECT_NEAR(centroid_mm(outline).x, -1000.0 / 700.0, 1e-12);
  EXPECT_DOUBLE_EQ(contour_length_mm(outline), 120.0 + 40.0);
}

TEST(Outline, RefusesWhatIsNoOutline) {
  const Vec2 two[] = {{0, 0}, {1, 0}};
  const Vec2 doubled[] = {{0, 0}, {10, 0}, {10, 0}, {0, 10}};
  EXPECT_THROW((void)rounded_polygon(two, 0.0), std::invalid_argument);
  EXPECT_THROW((void)rounded_polygon(doubled, 1.0), std::invalid_argument);
  EXPECT_THROW((void)circle({}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace flatpose::sim
