// The axis that a contour turns about, on shapes that are known.

#include "flatpose/teach/symmetry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "tests/lib/locate/made_scan.hpp"

namespace flatpose::teach {
namespace {

constexpr double kCenterX_mm = 17.0;
constexpr double kCenterY_mm = -9.0;

struct Corner {
  double x, y;
};

/// Contour points along an anticlockwise polygon, about one a millimetre and none at the corners.
model::Template polygon_part(const std::vector<Corner>& corners, double spacing_mm = 1.0) {
  model::Template part;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner a = corners[i];
    const Corner b = corners[(i + 1) % corners.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const double nx = (b.y - a.y) / length;
    const double ny = -(b.x - a.x) / length;
    for (double s = spacing_mm; s < length - 0.5 * spacing_mm; s += spacing_mm) {
      part.contour[part.contour_count++] = test::contour_point(
          a.x + (b.x - a.x) * s / length, a.y + (b.y - a.y) * s / length, nx, ny, 5.0);
    }
  }
  return part;
}

model::Template regular(int corner_count, double radius_mm = 30.0, double turn_rad = 0.2) {
  std::vector<Corner> corners;
  for (int i = 0; i < corner_count; ++i) {
    const double a = turn_rad + 2.0 * kPi * i / corner_count;
    corners.push_back(
        {kCenterX_mm + radius_mm * std::cos(a), kCenterY_mm + radius_mm * std::sin(a)});
  }
  return polygon_part(corners);
}

model::Template disc(double radius_mm = 30.0) {
  model::Template part = test::disc_part(radius_mm, 5.0, 180);
  for (model::ContourPoint& p : part.contour) {
    p.x_mm += static_cast<float>(kCenterX_mm);
    p.y_mm += static_cast<float>(kCenterY_mm);
  }
  return part;
}

model::Template rectangle(double w, double h) {
  const double x = kCenterX_mm - 0.5 * w;
  const double y = kCenterY_mm - 0.5 * h;
  return polygon_part({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
}

model::Template ell() {
  return polygon_part({{0, 0}, {60, 0}, {60, 20}, {20, 20}, {20, 50}, {0, 50}});
}

void expect_center(model::Template part, int order, double tolerance_mm) {
  part.symmetry.order = order;
  const Vec3 c = symmetry_center(part);
  EXPECT_NEAR(c.x, kCenterX_mm, tolerance_mm) << order;
  EXPECT_NEAR(c.y, kCenterY_mm, tolerance_mm) << order;
}

TEST(SymmetryCenter, IsWhereACircleHasIt) {
  expect_center(disc(), model::kFullSymmetry, 1e-4);
  // Also when only an arc of it is known.
  model::Template arc = disc();
  int kept = 0;
  for (int i = 0; i < arc.contour_count; ++i)
    if (arc.contour[i].nx > 0.2F) arc.contour[kept++] = arc.contour[i];
  arc.contour_count = kept;
  expect_center(arc, model::kFullSymmetry, 1e-3);
}

TEST(SymmetryCenter, IsWhereAPolygonHasIt) {
  expect_center(rectangle(60, 30), 2, 0.02);
  expect_center(rectangle(40, 40), 4, 0.02);
  for (int n = 3; n <= 8; ++n) expect_center(regular(n), n, 0.05);
}

TEST(SymmetryCenter, ForgivesAContourThatIsSeenUnevenly) {
  // Two of three points are missing on one half: the middle of the points moves, the axis does not.
  model::Template part = regular(6);
  int kept = 0;
  for (int i = 0; i < part.contour_count; ++i) {
    const bool keep = static_cast<double>(part.contour[i].x_mm) < kCenterX_mm || i % 3 == 0;
    if (keep) part.contour[kept++] = part.contour[i];
  }
  part.contour_count = kept;
  expect_center(part, 6, 0.3);
}

TEST(SymmetryCenter, OfARingIsLittleMovedByAHoleGoneAstray) {
  // A shadow moved the hole's contour; the outline has twice as many points and one centre.
  for (const double astray_mm : {0.5, 1.0, 2.0, 3.0}) {
    model::Template ring = disc();
    for (int i = 0; i < 90; ++i) {
      const double a = 2.0 * kPi * i / 90;
      ring.contour[ring.contour_count++] =
          test::contour_point(kCenterX_mm + astray_mm + 12.0 * std::cos(a),
                              kCenterY_mm + 12.0 * std::sin(a), -std::cos(a), -std::sin(a), 5.0);
    }
    expect_center(ring, model::kFullSymmetry, 0.25);
  }
}

TEST(SymmetryCenter, IsTheMiddleWithoutSymmetry) {
  model::Template part = rectangle(60, 30);
  expect_center(part, 1, 0.05);
}

TEST(OverlapAfterTurn, IsWholeForTurnsOfTheSymmetryOnly) {
  const model::Template square = rectangle(40, 40);
  for (int k = 0; k < 4; ++k)
    EXPECT_GT(overlap_after_turn(square, kCenterX_mm, kCenterY_mm, 0.5 * kPi * k, 0.5), 0.98);
  EXPECT_LT(overlap_after_turn(square, kCenterX_mm, kCenterY_mm, 0.25 * kPi, 0.5), 0.3);
  EXPECT_LT(overlap_after_turn(square, kCenterX_mm + 5.0, kCenterY_mm, 0.5 * kPi, 0.5), 0.8);
  EXPECT_LT(overlap_after_turn(ell(), 20.0, 20.0, kPi, 0.5), 0.5);
}

TEST(LikelySymmetry, TellsCircleSquareBarAndEll) {
  EXPECT_EQ(likely_symmetry(disc(), 1.0), model::kFullSymmetry);
  EXPECT_EQ(likely_symmetry(rectangle(40, 40), 1.0), 4);
  EXPECT_EQ(likely_symmetry(rectangle(60, 30), 1.0), 2);
  EXPECT_EQ(likely_symmetry(regular(3), 1.0), 3);
  EXPECT_EQ(likely_symmetry(regular(5), 1.0), 5);
  EXPECT_EQ(likely_symmetry(regular(6), 1.0), 6);
  EXPECT_EQ(likely_symmetry(ell(), 1.0), 1);
}

TEST(LikelySymmetry, SeesThroughASmallDeviation) {
  // 40 x 41: alike after a quarter turn within a millimetre, not within a tenth.
  EXPECT_EQ(likely_symmetry(rectangle(40, 41), 1.0), 4);
  EXPECT_EQ(likely_symmetry(rectangle(40, 41), 0.1), 2);
}

}  // namespace
}  // namespace flatpose::teach
