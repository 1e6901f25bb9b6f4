#include "port/sim/support_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "port/sim/random.hpp"

namespace flatpose::sim {
namespace {

double height_at(const SupportPlane& plane, const Vec3& p) {
  return plane.height_mm + plane.slope_x * p.x + plane.slope_y * p.y;
}

/// Height at the origin of the plane through three points whose triangle holds it.
std::optional<double> height_over_origin(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = a.x * b.y - a.y * b.x;
  const double bc = b.x * c.y - b.y * c.x;
  const double ca = c.x * a.y - c.y * a.x;
  const double area = ab + bc + ca;
  if (std::fabs(area) < 1e-12 || bc / area < 0.0 || ca / area < 0.0 || ab / area < 0.0) {
    return std::nullopt;
  }
  return (bc * a.z + ca * b.z + ab * c.z) / area;
}

/// By duality: the highest of all triangles over the origin.
std::optional<double> brute_force(const std::vector<Vec3>& points) {
  std::optional<double> highest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const auto height = height_over_origin(points[i], points[j], points[k]);
        if (height && (!highest || *height > *highest)) highest = height;
      }
    }
  }
  return highest;
}

void expect_right(const std::vector<Vec3>& points) {
  const auto plane = lowest_plane(points);
  const auto expected = brute_force(points);
  ASSERT_EQ(plane.has_value(), expected.has_value());
  if (!plane) return;
  EXPECT_NEAR(plane->height_mm, *expected, 1e-6);
  for (const Vec3& p : points) EXPECT_LE(p.z, height_at(*plane, p) + 1e-6);
  for (const int i : plane->touched) EXPECT_NEAR(points[i].z, height_at(*plane, points[i]), 1e-6);
  EXPECT_TRUE(height_over_origin(points[plane->touched[0]], points[plane->touched[1]],
                                 points[plane->touched[2]]));
}

TEST(LowestPlane, EqualsTheHighestTriangleOverTheOrigin) {
  Random random(1);
  int held = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<Vec3> points;
    const int count = 3 + random.index(12);
    for (int k = 0; k < count; ++k) {
      points.push_back({random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-10, 10)});
    }
    expect_right(points);
    held += lowest_plane(points).has_value();
  }
  EXPECT_GT(held, 1000);
  EXPECT_LT(held, 2000);
}

TEST(LowestPlane, IsRightOnGridsFullOfTies) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    std::vector<Vec3> points;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -2; x <= 2; ++x) {
        points.push_back({10.0 * x, 10.0 * y, 4.0 * random.index(3)});
      }
    }
    expect_right(points);
  }
}

TEST(LowestPlane, IsNoneWhenTheOriginHangsOver) {
  const std::vector<Vec3> aside{{1, -5, 0}, {9, 0, 0}, {1, 5, 0}};
  EXPECT_FALSE(lowest_plane(aside));
  EXPECT_FALSE(lowest_plane(std::vector<Vec3>{}));
  EXPECT_FALSE(lowest_plane(std::vector<Vec3>{{0, 0, 1}}));
}

}  // namespace
}  // namespace flatpose::sim
