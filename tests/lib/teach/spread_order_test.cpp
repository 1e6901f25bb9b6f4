#include "flatpose/teach/spread_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace flatpose::teach {
namespace {

struct Point {
  double x, y;
};

std::vector<Point> random_points(int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(0.0, 100.0);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) points.push_back({u(generator), u(generator)});
  return points;
}

struct Ordered {
  std::vector<int> order;
  int count = 0;
};

Ordered ordered(const std::vector<Point>& p, int count, int first = 0) {
  Ordered out;
  out.order.assign(static_cast<std::size_t>(count), -1);
  std::vector<double> nearest(p.size());
  out.count = spread_order(
      static_cast<int>(p.size()), first,
      [&](int a, int b) { return std::hypot(p[a].x - p[b].x, p[a].y - p[b].y); }, nearest,
      out.order);
  return out;
}

double nearest_of(const std::vector<Point>& p, const std::vector<int>& order, int prefix, int i) {
  double best = 1e300;
  for (int k = 0; k < prefix; ++k)
    best = std::min(best, std::hypot(p[i].x - p[order[k]].x, p[i].y - p[order[k]].y));
  return best;
}

TEST(SpreadOrder, EachIsTheFarthestFromAllBeforeIt) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Point> p = random_points(60, seed);
    const Ordered o = ordered(p, 40, static_cast<int>(seed));
    ASSERT_EQ(o.count, 40);
    EXPECT_EQ(o.order[0], static_cast<int>(seed));
    for (int k = 1; k < o.count; ++k) {
      const double own = nearest_of(p, o.order, k, o.order[k]);
      for (int i = 0; i < 60; ++i) EXPECT_LE(nearest_of(p, o.order, k, i), own + 1e-12);
    }
  }
}

TEST(SpreadOrder, EveryPrefixCoversWithinTwiceTheBest) {
  // Gonzalez 1985: farthest-first covers all points within twice the least radius; all triples of
  // few points tell what that is.
  for (unsigned seed = 0; seed < 10; ++seed) {
    const std::vector<Point> p = random_points(14, 100 + seed);
    const Ordered o = ordered(p, 14);
    const auto radius_of = [&](const std::vector<int>& chosen) {
      double radius = 0.0;
      for (int i = 0; i < 14; ++i)
        radius = std::max(radius, nearest_of(p, chosen, static_cast<int>(chosen.size()), i));
      return radius;
    };
    double best = 1e300;
    for (int a = 0; a < 14; ++a)
      for (int b = a + 1; b < 14; ++b)
        for (int c = b + 1; c < 14; ++c) best = std::min(best, radius_of({a, b, c}));
    EXPECT_LE(radius_of({o.order[0], o.order[1], o.order[2]}), 2.0 * best + 1e-12);
  }
}

/// Points of a rectangle on a grid, and the order that keeps off its border.
struct Field {
  static constexpr double kWidth = 100.0;
  static constexpr double kHeight = 70.0;
  std::vector<Point> points;

  Field() {
    for (double y = 0.5; y < kHeight; y += 1.0)
      for (double x = 0.5; x < kWidth; x += 1.0) points.push_back({x, y});
  }
  static double border_of(const Point& p) {
    return std::min({p.x, p.y, kWidth - p.x, kHeight - p.y});
  }
  [[nodiscard]] Ordered within(int count) const {
    Ordered out;
    out.order.assign(static_cast<std::size_t>(count), -1);
    std::vector<double> nearest(points.size());
    out.count = spread_order_within(
        static_cast<int>(points.size()), [&](int i) { return 2.0 * border_of(points[i]); },
        [&](int a, int b) {
          return std::hypot(points[a].x - points[b].x, points[a].y - points[b].y);
        },
        nearest, out.order);
    return out;
  }
  /// Share of the order's points in the strip along the border.
  [[nodiscard]] double share_at_border(const Ordered& o, double strip) const {
    int in_strip = 0;
    for (const int i : o.order) in_strip += border_of(points[i]) < strip ? 1 : 0;
    return 1.0 * in_strip / o.count;
  }
  static double area_at_border(double strip) {
    return 1.0 - (kWidth - 2.0 * strip) * (kHeight - 2.0 * strip) / (kWidth * kHeight);
  }
};

TEST(SpreadOrderWithin, IsAsDenseNearTheBorderAsInside) {
  const Field field;
  for (const int count : {40, 80, 160, 320}) {
    const double spacing = std::sqrt(Field::kWidth * Field::kHeight / count);
    const Ordered o = field.within(count);
    ASSERT_EQ(o.count, count);
    const double area = Field::area_at_border(spacing);
    EXPECT_NEAR(field.share_at_border(o, spacing), area, 0.2 * area) << count;
    // Half a spacing is left to the border, where the plain order begins with it.
    EXPECT_EQ(field.share_at_border(o, 0.3 * spacing), 0.0) << count;
    EXPECT_GT(field.share_at_border(ordered(field.points, count), 0.3 * spacing), 0.1) << count;
  }
}

TEST(SpreadOrderWithin, EachIsTheFarthestFromTheBorderAndAllBeforeIt) {
  const Field field;
  const Ordered o = field.within(30);
  const auto room = [&](int prefix, int i) {
    return std::min(2.0 * Field::border_of(field.points[i]),
                    nearest_of(field.points, o.order, prefix, i));
  };
  for (int k = 0; k < o.count; ++k) {
    const double own = room(k, o.order[k]);
    for (int i = 0; i < static_cast<int>(field.points.size()); ++i)
      ASSERT_LE(room(k, i), own + 1e-12) << k;
  }
}

TEST(SpreadOrder, TakesEachOnceAndNoCopies) {
  std::vector<Point> p = random_points(20, 5);
  const std::vector<Point> copies = p;
  p.insert(p.end(), copies.begin(), copies.end());
  const Ordered o = ordered(p, 40);
  EXPECT_EQ(o.count, 20);
  EXPECT_EQ(std::set<int>(o.order.begin(), o.order.begin() + o.count).size(), 20U);
}

TEST(SpreadOrder, TiesGoToTheLowerIndex) {
  const Ordered o = ordered({{0, 0}, {5, 0}, {-5, 0}, {0, 5}}, 4);
  EXPECT_EQ(o.order[1], 1);
  EXPECT_EQ(o.order, ordered({{0, 0}, {5, 0}, {-5, 0}, {0, 5}}, 4).order);
}

TEST(SpreadOrder, ServesWhatThereIs) {
  EXPECT_EQ(ordered({{1, 1}}, 5).count, 1);
  EXPECT_EQ(ordered(random_points(3, 1), 10).count, 3);
}

}  // namespace
}  // namespace flatpose::teach
