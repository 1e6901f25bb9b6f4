// The projected template against the algebra of poses in double precision.

#include <gtest/gtest.h>

#include <cmath>

#include "flatpose/geometry/pose.hpp"
#include "tests/lib/search/made_images.hpp"

namespace flatpose::search {
namespace {

struct Hypothesis {
  double slope_x, slope_y, angle_rad, cell_mm;

  [[nodiscard]] Vec3 normal() const { return normalized({-slope_x, -slope_y, 1.0}); }
  /// A turn about z, then the tilt as a turn about the line of level.
  [[nodiscard]] Rotation work_R_object() const {
    const double slope = std::hypot(slope_x, slope_y);
    const Vec3 axis = slope > 0.0 ? Vec3{slope_y / slope, -slope_x / slope, 0.0} : Vec3{1, 0, 0};
    const Rotation turn{{std::cos(angle_rad), -std::sin(angle_rad), 0, std::sin(angle_rad),
                         std::cos(angle_rad), 0, 0, 0, 1}};
    return rotation_from_vector(std::atan(slope) * axis) * turn;
  }
};

template <class Check>
void over_random_parts(unsigned seed, const Check& check) {
  std::mt19937 random(seed);
  for (int trial = 0; trial < 400; ++trial) {
    const auto part = random_part(random, 40.0);
    part->anchors[0] = {static_cast<float>(uniform(random, -20, 20)),
                        static_cast<float>(uniform(random, -20, 20)), 5.0F};
    check(*part, Hypothesis{uniform(random, -2, 2), uniform(random, -2, 2),
                            uniform(random, -2 * kPi, 2 * kPi), uniform(random, 0.3, 4.0)});
  }
}

ProjectedTemplate projected(const model::Template& part, const Hypothesis& h) {
  return project(part, part.anchors[0], h.slope_x, h.slope_y, h.angle_rad, h.cell_mm, {});
}

template <class Point>
Vec3 offset_mm(const model::Template& part, const Hypothesis& h, const Point& p) {
  return h.work_R_object() *
         Vec3{p.x_mm - part.anchors[0].x_mm, p.y_mm - part.anchors[0].y_mm, p.z_mm};
}

constexpr double kHalf = 0.5 + 1e-6;  // rounding to the nearest

TEST(Project, PutsEveryPointInTheCellItLiesIn) {
  over_random_parts(1, [](const model::Template& part, const Hypothesis& h) {
    const ProjectedTemplate t = projected(part, h);
    for (int i = 0; i < t.contour_count; ++i) {
      const Vec3 offset = offset_mm(part, h, part.contour[i]);
      EXPECT_NEAR(t.contour[i].dx, offset.x / h.cell_mm, kHalf);
      EXPECT_NEAR(t.contour[i].dy, offset.y / h.cell_mm, kHalf);
    }
    for (int i = 0; i < t.surface_count; ++i) {
      const Vec3 offset = offset_mm(part, h, part.surface[i]);
      EXPECT_NEAR(t.surface[i].dx, offset.x / h.cell_mm, kHalf);
      EXPECT_NEAR(t.surface[i].dy, offset.y / h.cell_mm, kHalf);
    }
  });
}

TEST(Project, MeasuresHeightsFromTheAnchorsPlane) {
  over_random_parts(2, [](const model::Template& part, const Hypothesis& h) {
    const ProjectedTemplate t = projected(part, h);
    for (int i = 0; i < t.surface_count; ++i) {
      const Vec3 offset = offset_mm(part, h, part.surface[i]);
      const double above_mm = offset.z - h.slope_x * offset.x - h.slope_y * offset.y;
      EXPECT_NEAR(t.surface[i].height_unit, above_mm * kHeightUnitsPerMm, kHalf + 1e-4);
    }
  });
}

TEST(Project, GivesNormalsAsDifferencesToTheAnchors) {
  over_random_parts(3, [](const model::Template& part, const Hypothesis& h) {
    const ProjectedTemplate t = projected(part, h);
    for (int i = 0; i < t.surface_count; ++i) {
      const double nx = part.surface[i].nx;
      const double ny = part.surface[i].ny;
      const Vec3 turned = h.work_R_object() * Vec3{nx, ny, std::sqrt(1.0 - nx * nx - ny * ny)};
      EXPECT_NEAR(t.surface[i].normal_x_unit, (turned.x - h.normal().x) * kNormalUnits, kHalf);
      EXPECT_NEAR(t.surface[i].normal_y_unit, (turned.y - h.normal().y) * kNormalUnits, kHalf);
    }
  });
}

TEST(Project, SortsFallingDirectionsIntoOctantsAsSeenFromAbove) {
  int checked = 0;
  over_random_parts(4, [&](const model::Template& part, const Hypothesis& h) {
    const ProjectedTemplate t = projected(part, h);
    for (int i = 0; i < t.contour_count; ++i) {
      const Vec3 d = h.work_R_object() * Vec3{part.contour[i].nx, part.contour[i].ny, 0.0};
      const double eighths = std::atan2(d.y, d.x) / (kPi / 4.0);
      if (std::fabs(eighths - std::floor(eighths) - 0.5) < 1e-4) continue;  // on the border
      ++checked;
      EXPECT_EQ(t.contour[i].octant, (static_cast<int>(std::lround(eighths)) + 8) % 8);
    }
  });
  EXPECT_GT(checked, 4000);
}

TEST(Project, WeighsEdgesByTheTilt) {
  over_random_parts(5, [](const model::Template& part, const Hypothesis& h) {
    EXPECT_NEAR(projected(part, h).edge_factor_q8, 256.0 / h.normal().z, 1.0);
  });
  std::mt19937 random(6);
  EXPECT_EQ(projected(*random_part(random, 5.0), {0, 0, 1, 1}).edge_factor_q8, 256);
}

TEST(Project, TakesTheFirstPointsThatTheConfigAsksFor) {
  std::mt19937 random(7);
  const auto part = random_part(random, 10.0, 40, 40);
  for (const auto& [asked, given] : {std::pair{0, 0}, {1, 1}, {17, 17}, {32, 32}, {1000, 32}}) {
    ScoreConfig config;
    config.contour_count = config.surface_count = asked;
    const ProjectedTemplate t = project(*part, part->anchors[0], 0.3, 0.1, 1.0, 1.0, config);
    EXPECT_EQ(t.contour_count, given);
    EXPECT_EQ(t.surface_count, given);
  }
  const auto small = random_part(random, 10.0, 2, 3);
  const ProjectedTemplate t = project(*small, small->anchors[0], 0, 0, 0, 1.0, {});
  EXPECT_EQ(t.contour_count, 2);
  EXPECT_EQ(t.surface_count, 3);
}

// A valid file may hold points a kilometre away: in 16 bits of cells they must not come round.
TEST(Project, KeepsPointsTooFarForItsIntegersOutsideTheField) {
  const MadeImages made(200, 200, 0.25);
  Place place;
  place.column = place.row = 100;
  for (double far_mm = 1e3; far_mm <= 1e6; far_mm *= 1.37) {
    for (const double sign : {-1.0, 1.0}) {
      auto part = std::make_unique<model::Template>();
      part->contour_count = part->surface_count = part->anchor_count = 1;
      const auto x_mm = static_cast<float>(sign * far_mm);
      part->contour[0].x_mm = part->contour[0].z_mm = x_mm;
      part->surface[0].y_mm = part->surface[0].z_mm = x_mm;
      const ProjectedTemplate t = project(*part, part->anchors[0], 0.2, 0, 0.1, 0.25, {});
      ScoreConfig config;
      EXPECT_EQ(cost(made.images, t, score_scale(config), place, 1 << 30),
                ((8 * t.edge_factor_q8) >> 8) + 8 + 4)
          << x_mm;
      EXPECT_EQ(t.surface[0].height_unit > 0, sign > 0) << x_mm;
    }
  }
}

}  // namespace
}  // namespace flatpose::search
