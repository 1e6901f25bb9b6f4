#include "flatpose/scene/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/lib/scene/made_scene.hpp"

namespace flatpose::scene {
namespace {

constexpr rectify::Method kMethods[] = {rectify::Method::kPaint, rectify::Method::kBucket};

/// Whether an edge is a piece of the contour: where it runs, falling outward by the box's height.
bool is_on_contour(const Built& built, const image::EdgePoint& e, const Box& box, double reach_mm) {
  const double x = built.x_mm(e);
  const double y = built.y_mm(e);
  constexpr double kCornerReach_mm = 2.0;
  if (box.is_near_corner(x, y)) return std::fabs(box.beyond_mm(x, y)) < kCornerReach_mm;
  const Box::Place out = box.outward(x, y);
  return std::fabs(box.beyond_mm(x, y)) < reach_mm && e.dx * out.along + e.dy * out.across > 0.9 &&
         std::fabs(e.step_mm - box.height_mm) < 0.25 * box.height_mm;
}

void expect_edges_on_contour(const Built& built, const Box& box, double reach_mm,
                             double stray_share = 0.0) {
  std::size_t strays = 0;
  for (const image::EdgePoint& e : built.scene.edges)
    strays += is_on_contour(built, e, box, reach_mm) ? 0 : 1;
  EXPECT_LE(static_cast<double>(strays),
            stray_share * static_cast<double>(built.scene.edges.size()));
}

/// Every place of the contour has an edge close by.
void expect_contour_covered(const Built& built, const Box& box, double reach_mm) {
  for (int i = 0; i < 400; ++i) {
    const double t = 2.0 * kPi * i / 400;
    const double m = std::min(box.length_mm / 2 / std::max(1e-9, std::fabs(std::cos(t))),
                              box.width_mm / 2 / std::max(1e-9, std::fabs(std::sin(t))));
    const double u = m * std::cos(t);
    const double v = m * std::sin(t);
    const double x = box.x_mm + u * std::cos(box.angle_rad) - v * std::sin(box.angle_rad);
    const double y = box.y_mm + u * std::sin(box.angle_rad) + v * std::cos(box.angle_rad);
    if (box.is_near_corner(x, y)) continue;
    double nearest_mm = 1e9;
    for (const image::EdgePoint& e : built.scene.edges) {
      nearest_mm = std::min(nearest_mm, std::hypot(built.x_mm(e) - x, built.y_mm(e) - y));
    }
    EXPECT_LT(nearest_mm, reach_mm) << x << ' ' << y;
  }
}

TEST(Scene, EdgesLieAtTheContourAndFallOutward) {
  for (const auto method : kMethods) {
    for (const double angle_rad : {0.0, 0.35, 0.785, 1.3}) {
      Box box;
      box.angle_rad = angle_rad;
      const Surroundings s;
      const Built built(scan_of(box, s), config_for(s, method));
      ASSERT_EQ(built.status, Status::kOk);
      ASSERT_GT(built.scene.edges.size(), 100U);
      expect_edges_on_contour(built, box, 1.2);
      expect_contour_covered(built, box, 2.0);
    }
  }
}

TEST(Scene, AContourOnASlopeIsFoundAsOnTheLevel) {
  Box box;
  box.angle_rad = 0.5;
  Surroundings s;
  s.slope_x = 0.3;
  s.slope_y = -0.2;
  s.noise_mm = 0.05;
  const Built built(scan_of(box, s), config_for(s));
  ASSERT_EQ(built.status, Status::kOk);
  // A wall's missing cells are filled by the lowest side, which on a slope may dig a pit beside it.
  expect_edges_on_contour(built, box, 1.5, 0.03);
  expect_contour_covered(built, box, 2.0);
}

TEST(Scene, AShadowKeepsTheContourAndMakesNoFarBorder) {
  for (const auto method : kMethods) {
    const Box box;
    Surroundings s;
    s.shadow_mm = 12.0;
    const Built built(scan_of(box, s), config_for(s, method));
    ASSERT_EQ(built.status, Status::kOk);
    expect_edges_on_contour(built, box, 1.8);
    expect_contour_covered(built, box, 2.0);
    int beside_the_shadow = 0;
    for (const image::EdgePoint& e : built.scene.edges) {
      if (e.dx > 0.9F) {
        EXPECT_EQ(e.kind, image::EdgeKind::kMissingBorder);
        ++beside_the_shadow;
      }
    }
    EXPECT_GT(beside_the_shadow, 20);
  }
}

TEST(Scene, NoiseOnAPlaneMakesNoEdges) {
  Box none;
  none.height_mm = 0.0;
  for (const auto& [sx, sy] : {std::pair{0.0, 0.0}, {0.4, -0.3}}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      Surroundings s;
      s.noise_mm = 0.3;
      s.slope_x = sx;
      s.slope_y = sy;
      s.seed = seed;
      const Built built(scan_of(none, s), config_for(s));
      ASSERT_EQ(built.status, Status::kOk);
      EXPECT_TRUE(built.scene.edges.empty()) << built.scene.edges.size() << " of seed " << seed;
    }
  }
}

TEST(Scene, NoiseLeavesTheContourWhereItIs) {
  const Box box;
  Surroundings s;
  s.noise_mm = 0.3;
  const Built built(scan_of(box, s), config_for(s));
  ASSERT_EQ(built.status, Status::kOk);
  for (const image::EdgePoint& e : built.scene.edges) {
    EXPECT_LT(std::fabs(box.beyond_mm(built.x_mm(e), built.y_mm(e))), 2.0);
  }
  expect_contour_covered(built, box, 2.0);
}

TEST(EdgeThreshold, RisesWithNoiseAndStepAndStaysBetweenThem) {
  SceneConfig config;
  double previous_mm = 0.0;
  for (const double noise_mm : {0.01, 0.05, 0.1, 0.4, 1.0}) {
    config.noise_mm = noise_mm;
    EXPECT_GT(edge_threshold_mm(config), previous_mm);
    EXPECT_GE(edge_threshold_mm(config), 3.0 * noise_mm) << "noise must stay below it";
    previous_mm = edge_threshold_mm(config);
  }
  config.noise_mm = 0.01;
  previous_mm = 0.0;
  for (const double step_mm : {1.0, 3.0, 9.0}) {
    config.step_mm = step_mm;
    EXPECT_GT(edge_threshold_mm(config), previous_mm);
    EXPECT_LT(edge_threshold_mm(config), step_mm) << "the part's own step must pass";
    previous_mm = edge_threshold_mm(config);
  }
  const double quiet_mm = previous_mm;
  config.noise_mm = 50.0;
  EXPECT_GT(edge_threshold_mm(config), quiet_mm) << "noise counts, however large the step";
}

TEST(Scene, StepsFarBelowThePartsOwnAreClutter) {
  Box low;
  low.height_mm = 1.5;
  const Surroundings s;
  SceneConfig config = config_for(s);
  EXPECT_GT(Built(scan_of(low, s), config).scene.edges.size(), 100U);
  config.step_mm = 12.0;
  const Built built(scan_of(low, s), config);
  ASSERT_EQ(built.status, Status::kOk);
  EXPECT_TRUE(built.scene.edges.empty());
}

TEST(Scene, BothWaysToRectifyAgree) {
  Box box;
  box.angle_rad = 0.35;
  Surroundings s;
  s.slope_x = 0.1;
  s.pitch_mm = 0.5;
  const Scan scan = scan_of(box, s);
  const Built paint(scan, config_for(s, rectify::Method::kPaint));
  const Built bucket(scan, config_for(s, rectify::Method::kBucket));
  ASSERT_EQ(paint.status, Status::kOk);
  ASSERT_EQ(bucket.status, Status::kOk);
  int compared = 0;
  const rectify::Grid grid = made_grid();
  for (int y = 0; y < grid.height_px; ++y) {
    for (int x = 0; x < grid.width_px; ++x) {
      if (std::fabs(box.beyond_mm(grid.x_of(x), grid.y_of(y))) < 2.0) continue;
      ++compared;
      EXPECT_NEAR(paint.scene.filled_mm(x, y), bucket.scene.filled_mm(x, y), 0.1);
    }
  }
  EXPECT_GT(compared, 5000);
  for (const image::EdgePoint& e : paint.scene.edges) {
    double nearest_px = 1e9;
    for (const image::EdgePoint& other : bucket.scene.edges) {
      nearest_px =
          std::min<double>(nearest_px, std::hypot(e.x_px - other.x_px, e.y_px - other.y_px));
    }
    EXPECT_LT(nearest_px, 1.5);
  }
}

TEST(Scene, IsRectifiedAsAsked) {
  // A point alone makes no triangle, but a median.
  const Surroundings s;
  Scan scan = scan_of(Box{}, s);
  for (int r = 0; r < scan.height_px; ++r) {
    for (int c = 0; c < 30; ++c) {
      if (r != 50 || c != 15) scan.lose(c, r);
    }
  }
  const int column = static_cast<int>(std::lround(made_grid().column_of(15 * s.pitch_mm)));
  const int row = static_cast<int>(std::lround(made_grid().row_of(50 * s.pitch_mm)));
  const Built paint(scan, config_for(s, rectify::Method::kPaint));
  const Built bucket(scan, config_for(s, rectify::Method::kBucket));
  EXPECT_EQ(paint.scene.missing(column, row), 1);
  EXPECT_EQ(bucket.scene.missing(column, row), 0);
}

TEST(Scene, EdgeListAndEdgeMapAreOne) {
  const Surroundings s;
  const Built built(scan_of(Box{}, s), config_for(s));
  std::size_t marked = 0;
  for (int y = 0; y < built.scene.edge_kind.height_px; ++y) {
    for (int x = 0; x < built.scene.edge_kind.width_px; ++x)
      marked += built.scene.edge_kind(x, y) != 0 ? 1 : 0;
  }
  EXPECT_EQ(marked, built.scene.edges.size());
  for (const image::EdgePoint& e : built.scene.edges) {
    EXPECT_EQ(built.scene.edge_kind(e.column, e.row), static_cast<std::uint8_t>(e.kind));
  }
}

TEST(Scene, AScanThatLooksDownGivesTheSameScene) {
  const Box box;
  Surroundings s;
  s.shadow_mm = 6.0;
  s.noise_mm = 0.05;
  const Scan up = scan_of(box, s);
  Scan down = up;
  for (int r = 0; r < up.height_px; ++r) {
    for (int c = 0; c < up.width_px; ++c) {
      const Vec3 p = up.view()(c, r);
      down.set(c, r, {p.x, -p.y, -p.z});
    }
  }
  const Built a(up, config_for(s));
  const Built b(down, config_for(s), frames_of_scan(false));
  ASSERT_EQ(a.scene.edges.size(), b.scene.edges.size());
  for (std::size_t i = 0; i < a.scene.edges.size(); ++i) {
    EXPECT_EQ(a.scene.edges[i].x_px, b.scene.edges[i].x_px);
    EXPECT_EQ(a.scene.edges[i].dy, b.scene.edges[i].dy);
  }
}

}  // namespace
}  // namespace flatpose::scene
