// The projected template against the algebra of poses in double precision.

#include <gtest/gtest.h>

#include <cmath>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/image/edge.hpp"
#include "flatpose/search/score.hpp"
#include "tests/lib/search/made_parts.hpp"

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

/// Images as far as project() looks at them.
SearchImages images_for(std::mt19937& random, double cell_mm, int reach_px = kReachMax_px) {
  SearchImages images;
  images.grid.cell_mm = cell_mm;
  images.config.normal_tolerance_rad = uniform(random, 0.1, 0.6);
  images.height_unit_mm = uniform(random, 0.02, 1.0);
  images.lattice = make_lattice(1, 1, 1, reach_px);
  return images;
}

/// Parts, tilts and angles of all kinds, no point out of reach.
template <class Check>
void over_random_parts(unsigned seed, const Check& check) {
  std::mt19937 random(seed);
  for (int trial = 0; trial < 400; ++trial) {
    const auto part = random_part(random, 40.0, 17, 25);
    part->anchors[0] = {static_cast<float>(uniform(random, -20, 20)),
                        static_cast<float>(uniform(random, -20, 20)), 5.0F};
    const Hypothesis h{uniform(random, -2, 2), uniform(random, -2, 2),
                       uniform(random, -2 * kPi, 2 * kPi), uniform(random, 0.5, 4.0)};
    const SearchImages images = images_for(random, h.cell_mm);
    const ScoreConfig all{kContourCountMax, kSurfaceCountMax};
    const ProjectedTemplate t =
        project(*part, part->anchors[0], h.slope_x, h.slope_y, h.angle_rad, images, all);
    ASSERT_EQ(t.contour_count, part->contour_count);
    ASSERT_EQ(t.surface_count, part->surface_count);
    check(*part, h, images, t);
  }
}

template <class Point>
Vec3 offset_mm(const model::Template& part, const Hypothesis& h, const Point& p) {
  return h.work_R_object() *
         Vec3{p.x_mm - part.anchors[0].x_mm, p.y_mm - part.anchors[0].y_mm, p.z_mm};
}

constexpr double kHalf = 0.5 + 1e-6;  // rounding to the nearest

TEST(Project, PutsEveryPointInTheCellItLiesIn) {
  over_random_parts(1, [](const model::Template& part, const Hypothesis& h, const SearchImages&,
                          const ProjectedTemplate& t) {
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

/// What the cell's middle would measure: the point's height over the anchor's plane, and the plane.
template <class Projected>
double rise_mm(const Hypothesis& h, const Vec3& offset, const Projected& at) {
  const double above_mm = offset.z - h.slope_x * offset.x - h.slope_y * offset.y;
  return above_mm + h.cell_mm * (h.slope_x * at.dx + h.slope_y * at.dy);
}

TEST(Project, ExpectsTheHeightThatThePlaneHasInTheMiddleOfTheCell) {
  over_random_parts(2, [](const model::Template& part, const Hypothesis& h,
                          const SearchImages& images, const ProjectedTemplate& t) {
    const double unit_mm = images.height_unit_mm;
    for (int i = 0; i < t.contour_count; ++i) {
      const Vec3 offset = offset_mm(part, h, part.contour[i]);
      EXPECT_NEAR(t.contour[i].rise_unit, rise_mm(h, offset, t.contour[i]) / unit_mm, kHalf);
    }
    for (int i = 0; i < t.surface_count; ++i) {
      const Vec3 offset = offset_mm(part, h, part.surface[i]);
      EXPECT_NEAR(t.surface[i].rise_unit, rise_mm(h, offset, t.surface[i]) / unit_mm, kHalf);
    }
  });
}

TEST(Project, GivesNormalsInUnitsOfTheTolerance) {
  over_random_parts(3, [](const model::Template& part, const Hypothesis& h,
                          const SearchImages& images, const ProjectedTemplate& t) {
    const double unit = images.config.normal_tolerance_rad / kSurfaceCostMax;
    for (int i = 0; i < t.surface_count; ++i) {
      const double nx = part.surface[i].nx;
      const double ny = part.surface[i].ny;
      const Vec3 turned = h.work_R_object() * Vec3{nx, ny, std::sqrt(1.0 - nx * nx - ny * ny)};
      EXPECT_NEAR(t.surface[i].normal_x_unit, 127.0 + turned.x / unit, kHalf);
      EXPECT_NEAR(t.surface[i].normal_y_unit, 127.0 + turned.y / unit, kHalf);
    }
  });
}

TEST(Project, SortsFallingDirectionsIntoOctantsAsSeenFromAbove) {
  int checked = 0;
  over_random_parts(4, [&](const model::Template& part, const Hypothesis& h, const SearchImages&,
                           const ProjectedTemplate& t) {
    for (int i = 0; i < t.contour_count; ++i) {
      const Vec3 d = h.work_R_object() * Vec3{part.contour[i].nx, part.contour[i].ny, 0.0};
      const double eighths = std::atan2(d.y, d.x) / (kPi / 4.0);
      if (std::fabs(eighths - std::floor(eighths) - 0.5) < 1e-4) continue;  // on the border
      ++checked;
      EXPECT_EQ(t.contour[i].octant, (static_cast<int>(std::lround(eighths)) + 8) % 8);
    }
  });
  EXPECT_GT(checked, 6000);
}

TEST(Project, WeighsEdgesByTheTiltUpToSixtyDegrees) {
  over_random_parts(5, [](const model::Template&, const Hypothesis& h, const SearchImages&,
                          const ProjectedTemplate& t) {
    const double factor_q8 = std::min(256.0 / h.normal().z, 512.0);
    EXPECT_LE(t.edge_factor_q8, factor_q8 + 1e-9);
    EXPECT_GT(t.edge_factor_q8, factor_q8 - 1.0 - 1e-9);
  });
  std::mt19937 random(6);
  const auto part = random_part(random, 5.0);
  const SearchImages images = images_for(random, 1.0);
  const auto factor_q8 = [&](double slope_x, double slope_y) {
    return project(*part, part->anchors[0], slope_x, slope_y, 1.0, images, {}).edge_factor_q8;
  };
  EXPECT_EQ(factor_q8(0.0, 0.0), 256);
  EXPECT_EQ(factor_q8(1.0, 0.0), 362) << "a 45 degrees slope";
  EXPECT_LT(factor_q8(0.0, 1.72), 512);
  EXPECT_EQ(factor_q8(0.0, -1.74), 512) << "60 degrees and more";
  EXPECT_EQ(factor_q8(1.92, 1.92), 512);
  EXPECT_EQ(factor_q8(1e6, 0.0), 512);
}

TEST(Project, TakesTheFirstPointsThatTheConfigAsksFor) {
  std::mt19937 random(7);
  const SearchImages images = images_for(random, 1.0);
  const auto part = random_part(random, 10.0, 40, 40);
  const auto counts = [&](const model::Template& of, int contour, int surface) {
    const ProjectedTemplate t =
        project(of, of.anchors[0], 0.3, 0.1, 1.0, images, ScoreConfig{contour, surface});
    return std::pair{t.contour_count, t.surface_count};
  };
  EXPECT_EQ(counts(*part, 0, 0), std::pair(0, 0));
  EXPECT_EQ(counts(*part, -5, -1), std::pair(0, 0));
  EXPECT_EQ(counts(*part, 3, 17), std::pair(3, 17));
  EXPECT_EQ(counts(*part, 1000, 1000), std::pair(kContourCountMax, kSurfaceCountMax));
  EXPECT_EQ(counts(*random_part(random, 10.0, 2, 3), 10, 10), std::pair(2, 3));
}

TEST(Project, LeavesOutWhatLiesBeyondReachAndKeepsTheOrderOfTheRest) {
  std::mt19937 random(8);
  int left_out = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto part = random_part(random, 40.0, 17, 25);
    const double angle_rad = uniform(random, -kPi, kPi);
    const SearchImages far = images_for(random, 1.0);
    SearchImages near = far;
    near.lattice = make_lattice(1, 1, integer(random, 1, kStrideMax_px), integer(random, 5, 30));
    const int reach_px = near.lattice.reach_px();
    const ScoreConfig all{kContourCountMax, kSurfaceCountMax};
    const auto whole = project(*part, part->anchors[0], 0.2, -0.1, angle_rad, far, all);
    const auto found = project(*part, part->anchors[0], 0.2, -0.1, angle_rad, near, all);
    const auto is_within = [&](const auto& p) {
      return std::abs(p.dx) <= reach_px && std::abs(p.dy) <= reach_px;
    };
    int kept = 0;
    for (int i = 0; i < whole.contour_count; ++i) {
      if (!is_within(whole.contour[i])) continue;
      ASSERT_LT(kept, found.contour_count);
      EXPECT_EQ(found.contour[kept].dx, whole.contour[i].dx);
      EXPECT_EQ(found.contour[kept].rise_unit, whole.contour[i].rise_unit);
      ++kept;
    }
    EXPECT_EQ(found.contour_count, kept);
    kept = 0;
    for (int i = 0; i < whole.surface_count; ++i) {
      if (!is_within(whole.surface[i])) continue;
      ASSERT_LT(kept, found.surface_count);
      EXPECT_EQ(found.surface[kept].dy, whole.surface[i].dy);
      ++kept;
    }
    EXPECT_EQ(found.surface_count, kept);
    left_out += whole.surface_count - kept;
  }
  EXPECT_GT(left_out, 200);
}

// A valid file may hold points a kilometre away: in 16 bits of cells they must not come round.
TEST(Project, LeavesOutPointsTooFarForItsIntegersAndSaturatesHeights) {
  std::mt19937 random(9);
  const SearchImages images = images_for(random, 0.25);
  for (double far_mm = 1e3; far_mm <= 1e7; far_mm *= 1.37) {
    for (const double sign : {-1.0, 1.0}) {
      auto part = std::make_unique<model::Template>();
      part->contour_count = part->surface_count = 2;
      part->anchor_count = 1;
      const auto value_mm = static_cast<float>(sign * far_mm);
      part->contour[0].x_mm = part->surface[0].y_mm = value_mm;
      part->contour[1].z_mm = part->surface[1].z_mm = 100.0F * value_mm;
      const ProjectedTemplate t = project(*part, part->anchors[0], 0, 0, 0.1, images, {});
      ASSERT_EQ(t.contour_count, 1) << far_mm;
      ASSERT_EQ(t.surface_count, 1) << far_mm;
      EXPECT_EQ(t.contour[0].rise_unit, sign * 32767);
      EXPECT_EQ(t.surface[0].rise_unit, sign * 32767);
    }
  }
}

TEST(Project, TakesTheOctantOfAnyDirectionAsTheEdgesDo) {
  constexpr float kTanEighthOfPi = 0.41421356F;  // where octants meet
  std::vector<float> components{0.0F, kTanEighthOfPi, 1.0F, 0.3F, 0.7F};
  for (const float near : {kTanEighthOfPi, 1.0F}) {
    components.push_back(std::nextafter(near, 0.0F));
    components.push_back(std::nextafter(near, 2.0F));
  }
  for (std::size_t i = components.size(); i-- > 0;) components.push_back(-components[i]);
  std::mt19937 random(11);
  const SearchImages images = images_for(random, 1.0);
  model::Template part;
  part.anchor_count = 1;
  part.contour_count = kContourCountMax;  // more than one vector
  for (const float nx : components) {
    for (const float ny : components) {
      for (auto& p : part.contour) p.nx = ny, p.ny = nx;
      part.contour[7].nx = nx;
      part.contour[7].ny = ny;
      const ScoreConfig all{kContourCountMax, 0};
      const ProjectedTemplate t = project(part, part.anchors[0], 0.0, 0.0, 0.0, images, all);
      ASSERT_EQ(t.contour[7].octant, image::octant_of(nx, ny)) << nx << ", " << ny;
      ASSERT_EQ(t.contour[16].octant, image::octant_of(ny, nx)) << ny << ", " << nx;
    }
  }
}

TEST(Project, OfAnAnchorFarOutsideThePartHasNoPoints) {
  std::mt19937 random(10);
  const SearchImages images = images_for(random, 1.0);
  const auto part = random_part(random, 10.0);
  for (const float far_mm : {300.0F, 1e5F, 1e9F}) {
    part->anchors[0].x_mm = far_mm;
    const ProjectedTemplate t = project(*part, part->anchors[0], 0.1, 0.1, 0.5, images, {});
    EXPECT_EQ(t.contour_count, 0) << far_mm;
    EXPECT_EQ(t.surface_count, 0) << far_mm;
    EXPECT_EQ(cost_max(images, t), 0);
  }
}

}  // namespace
}  // namespace flatpose::search
