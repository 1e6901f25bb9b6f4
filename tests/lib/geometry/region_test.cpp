#include "flatpose/geometry/region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose {
namespace {

struct Point {
  double x, y;
};

Region polygon(const std::vector<Point>& corners, Region::Kind kind = Region::Kind::kPolygon) {
  Region region;
  region.kind = kind;
  region.vertex_count = static_cast<int>(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    region.vertex_x_mm[i] = corners[i].x;
    region.vertex_y_mm[i] = corners[i].y;
  }
  return region;
}

Region box(Point a, Point b) { return polygon({a, b}, Region::Kind::kBox); }

Region circle(Point centre, double radius_mm) {
  Region region;
  region.kind = Region::Kind::kCircle;
  region.x_mm = centre.x;
  region.y_mm = centre.y;
  region.radius_mm = radius_mm;
  return region;
}

/// How often the polygon turns around the point, by adding up the angles under which its sides are
/// seen. Inside by the even-odd rule where the count is odd.
int winding_number(const std::vector<Point>& corners, Point p) {
  double sum_rad = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point a = corners[i];
    const Point b = corners[(i + 1) % corners.size()];
    const double ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y;
    sum_rad += std::atan2(ax * by - ay * bx, ax * bx + ay * by);
  }
  return static_cast<int>(std::lround(sum_rad / (2.0 * kPi)));
}

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int integer(int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator_);
  }
  Point point(double reach) { return {uniform(-reach, reach), uniform(-reach, reach)}; }

 private:
  std::mt19937 generator_;
};

TEST(Region, AllContainsEverything) {
  EXPECT_TRUE(Region{}.contains(1e30, -1e30));
  EXPECT_TRUE(is_valid(Region{}));
}

TEST(Region, CircleHoldsWhatIsWithinItsRadius) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Point c = random.point(50.0);
    const double radius_mm = random.uniform(0.1, 30.0);
    const Point p = random.point(80.0);
    const double distance_mm = std::hypot(p.x - c.x, p.y - c.y);
    if (std::fabs(distance_mm - radius_mm) < 1e-9) continue;
    EXPECT_EQ(circle(c, radius_mm).contains(p.x, p.y), distance_mm < radius_mm);
  }
  EXPECT_TRUE(circle({1, 2}, 5).contains(4, 6)) << "the border belongs to it";
}

TEST(Region, BoxTakesItsCornersInAnyOrderAndHoldsItsBorder) {
  for (const auto& [a, b] : {std::pair<Point, Point>{{-1, 2}, {3, 7}},
                             {{3, 7}, {-1, 2}},
                             {{3, 2}, {-1, 7}},
                             {{-1, 7}, {3, 2}}}) {
    const Region region = box(a, b);
    EXPECT_TRUE(is_valid(region));
    for (const double x : {-1.0, 0.5, 3.0}) {
      for (const double y : {2.0, 5.0, 7.0}) EXPECT_TRUE(region.contains(x, y));
    }
    for (const Point p : {Point{-1.001, 5}, {3.001, 5}, {0, 1.999}, {0, 7.001}}) {
      EXPECT_FALSE(region.contains(p.x, p.y));
    }
  }
}

TEST(Region, PolygonAgreesWithTheWindingNumberOfStars) {
  // Stars of one turn around their centre do not cross themselves: here both rules are one.
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Point centre = random.point(20.0);
    const int corner_count = random.integer(3, 12);
    std::vector<Point> corners;
    for (int i = 0; i < corner_count; ++i) {
      const double angle_rad = 2.0 * kPi * i / corner_count;
      const double reach = random.uniform(2.0, 15.0);
      corners.push_back(
          {centre.x + reach * std::cos(angle_rad), centre.y + reach * std::sin(angle_rad)});
    }
    const Region region = polygon(corners);
    ASSERT_TRUE(is_valid(region));
    for (int i = 0; i < 100; ++i) {
      const Point p{centre.x + random.uniform(-18, 18), centre.y + random.uniform(-18, 18)};
      EXPECT_EQ(region.contains(p.x, p.y), winding_number(corners, p) != 0);
    }
  }
}

TEST(Region, PolygonFollowsTheEvenOddRuleWhereItCrossesItself) {
  Random random(3);
  int twice_around = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Point> corners(static_cast<std::size_t>(random.integer(5, 20)));
    for (Point& corner : corners) corner = random.point(10.0);
    for (int i = 0; i < 50; ++i) {
      const Point p = random.point(10.0);
      const int turns = winding_number(corners, p);
      EXPECT_EQ(polygon(corners).contains(p.x, p.y), turns % 2 != 0);
      twice_around += turns == 2 || turns == -2 ? 1 : 0;
    }
  }
  EXPECT_GT(twice_around, 100) << "the case where the two rules differ was not met";
}

TEST(Region, PolygonsThatShareSidesLeaveNoGapAndNoOverlap) {
  // A grid of points through the corners themselves: every point belongs to exactly one of the
  // triangles around an inner corner.
  const std::vector<Point> ring{{2, 0}, {1, 2}, {-1, 2}, {-2, 0}, {-1, -2}, {1, -2}};
  for (double y = -1.5; y <= 1.5; y += 0.25) {
    for (double x = -1.0; x <= 1.0; x += 0.25) {
      int holders = 0;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Region triangle = polygon({{0, 0}, ring[i], ring[(i + 1) % ring.size()]});
        holders += triangle.contains(x, y) ? 1 : 0;
      }
      EXPECT_EQ(holders, 1) << x << ' ' << y;
    }
  }
}

TEST(Region, BoundingBoxIsTheSmallestThatHoldsIt) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Point> corners(static_cast<std::size_t>(random.integer(3, 64)));
    for (Point& corner : corners) corner = random.point(40.0);
    const Box bounds = bounding_box(polygon(corners));
    double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
    for (const Point& corner : corners) {
      x0 = std::min(x0, corner.x);
      y0 = std::min(y0, corner.y);
      x1 = std::max(x1, corner.x);
      y1 = std::max(y1, corner.y);
    }
    EXPECT_EQ(bounds.x0_mm, x0);
    EXPECT_EQ(bounds.y0_mm, y0);
    EXPECT_EQ(bounds.x1_mm, x1);
    EXPECT_EQ(bounds.y1_mm, y1);
  }
  const Box round = bounding_box(circle({3, -4}, 5));
  EXPECT_EQ(round.x0_mm, -2);
  EXPECT_EQ(round.y0_mm, -9);
  EXPECT_EQ(round.x1_mm, 8);
  EXPECT_EQ(round.y1_mm, 1);
}

TEST(Region, NothingOutsideTheBoundingBoxIsContained) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Point> corners(static_cast<std::size_t>(random.integer(3, 9)));
    for (Point& corner : corners) corner = random.point(10.0);
    for (const Region& region :
         {polygon(corners), box(corners[0], corners[1]), circle(corners[0], 4.0)}) {
      const Box b = bounding_box(region);
      for (int i = 0; i < 30; ++i) {
        const Point p = random.point(20.0);
        const bool in_box = p.x >= b.x0_mm && p.x <= b.x1_mm && p.y >= b.y0_mm && p.y <= b.y1_mm;
        if (!in_box) {
          EXPECT_FALSE(region.contains(p.x, p.y));
        }
      }
    }
  }
}

TEST(Region, NumbersThatAreNotFiniteAreRefused) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(is_valid(circle({bad, 0}, 1)));
    EXPECT_FALSE(is_valid(circle({0, bad}, 1)));
    EXPECT_FALSE(is_valid(circle({0, 0}, bad)));
    EXPECT_FALSE(is_valid(box({bad, 0}, {1, 1})));
    EXPECT_FALSE(is_valid(box({0, 0}, {1, bad})));
    for (int i = 0; i < 4; ++i) {
      std::vector<Point> corners{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      ASSERT_TRUE(is_valid(polygon(corners)));
      corners[static_cast<std::size_t>(i)].x = bad;
      EXPECT_FALSE(is_valid(polygon(corners)));
    }
  }
}

TEST(Region, WhatEnclosesNoAreaIsRefused) {
  EXPECT_FALSE(is_valid(circle({0, 0}, 0)));
  EXPECT_FALSE(is_valid(circle({0, 0}, -1)));
  EXPECT_FALSE(is_valid(box({1, 1}, {1, 5})));
  EXPECT_FALSE(is_valid(box({1, 5}, {3, 5})));
  EXPECT_FALSE(is_valid(polygon({{0, 0}, {1, 0}, {2, 0}})));
  EXPECT_FALSE(is_valid(polygon({{0, 0}, {0, 1}, {0, -2}})));
  EXPECT_FALSE(is_valid(polygon({{1, 1}, {1, 1}, {1, 1}})));
  EXPECT_FALSE(is_valid(polygon({{0, 0}, {1, 1}, {2, 2}}))) << "a line that slants is a line";
  EXPECT_FALSE(is_valid(polygon({{1, 2}, {1, 2}, {4, 8}, {-1, -2}})));
  EXPECT_TRUE(is_valid(polygon({{0, 0}, {1, 1}, {2, 2}, {2, 2.001}})));
}

TEST(Region, CountsOutsideTheLimitsAreRefused) {
  std::vector<Point> corners;
  for (int i = 0; i < Region::kVertexCountMax; ++i) {
    corners.push_back({std::cos(0.1 * i), std::sin(0.1 * i)});
  }
  Region region = polygon(corners);
  EXPECT_TRUE(is_valid(region));
  for (const int count : {Region::kVertexCountMax + 1, 1 << 30, 2, 1, 0, -1}) {
    region.vertex_count = count;
    EXPECT_FALSE(is_valid(region)) << count;
  }
  region.kind = Region::Kind::kBox;
  region.vertex_count = 1;
  EXPECT_FALSE(is_valid(region));
}

// Against the nearest of many points beside: where contains() changes there is the border.
TEST(Region, BorderDistanceIsThatToTheNearestOtherSide) {
  Region round, box, polygon;
  round.kind = Region::Kind::kCircle;
  round.x_mm = 1.0;
  round.radius_mm = 3.0;
  box.kind = Region::Kind::kBox;
  box.vertex_count = 2;
  box.vertex_x_mm = {-2.0, 3.0};
  box.vertex_y_mm = {4.0, -1.0};
  polygon.kind = Region::Kind::kPolygon;
  polygon.vertex_count = 5;  // a notch
  polygon.vertex_x_mm = {-3.0, 3.0, 3.0, 0.0, -3.0};
  polygon.vertex_y_mm = {-3.0, -3.0, 3.0, 0.0, 3.0};
  constexpr double kStep = 0.05;
  for (const Region& region : {round, box, polygon}) {
    for (double x = -4.0; x <= 4.0; x += 0.77) {
      for (double y = -4.0; y <= 4.0; y += 0.77) {
        double least = 1e9;
        for (double u = -9.0; u <= 9.0; u += kStep)
          for (double v = -9.0; v <= 9.0; v += kStep)
            if (region.contains(u, v) != region.contains(x, y))
              least = std::min(least, std::hypot(u - x, v - y));
        EXPECT_NEAR(region.border_distance_mm(x, y), least, 1.5 * kStep);
      }
    }
  }
  EXPECT_EQ(Region{}.border_distance_mm(0, 0), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace flatpose
