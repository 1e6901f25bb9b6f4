// What the candidates of the grid search say: their poses, and that a part on a slope costs next to
// nothing although its template was turned to the nearest of a few tilts.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/lib/search/made_ground.hpp"

namespace flatpose::search {
namespace {

// The pose of a candidate is the hypothesis: the anchor on the plane at its place, z along the
// plane's normal, turned by its angle.
TEST(GridSearch, GivesPosesThatLieOnTheSurface) {
  for (const auto& [sx, sy] : {std::pair{0.0, 0.0}, {0.3, -0.2}, {-0.6, 0.45}}) {
    std::mt19937 random(9);
    MadeGround ground(30, 26);
    ground.made.images.grid = {-11.0, 4.0, 1.5, 30, 26};
    ground.made.randomise(random);
    ground.field.for_each([&, a = sx, b = sy](int x, int y) {
      ground.field.slope_x(x, y) = static_cast<float>(a);
      ground.field.slope_y(x, y) = static_cast<float>(b);
      ground.field.plane_mm(x, y) = static_cast<float>(1.5 * (a * x + b * y) + 100.0);
    });
    ground.collect({.max_tilt_rad = 0.9});
    const auto part = random_part(random, 8.0);
    part->anchors[0] = {2.5F, -1.5F, 3.0F};
    GridSearchConfig config;
    config.angle_step_rad = 0.4;
    config.cost_share_max = 1.0;
    const Found found = ground.run(*part, config);
    ASSERT_FALSE(found.candidates.empty());
    const int angles = searched_angles(*part, config);
    for (const Candidate& c : found.candidates) {
      const Vec3 anchor_mm = c.work_T_object * Vec3{2.5, -1.5, 0.0};
      EXPECT_NEAR(anchor_mm.x, -11.0 + 1.5 * c.column, 1e-9);
      EXPECT_NEAR(anchor_mm.y, 4.0 + 1.5 * c.row, 1e-9);
      EXPECT_NEAR(anchor_mm.z, ground.field.plane_mm(c.column, c.row), 1e-9);
      const Rotation& r = c.work_T_object.rotation;
      EXPECT_NEAR(norm(r.column(2) - normalized({-sx, -sy, 1.0})), 0.0, 1e-6);
      const Rotation turn = tilt_rotation(r.column(2)).inverse() * r;
      const double angle_rad = 2.0 * kPi * c.angle_index / angles;
      EXPECT_NEAR(angle_between_rad(turn, rotation_about_z(angle_rad)), 0.0, 1e-9);
    }
  }
}

/// Draws the edges of one part in the middle of a plane, exactly where the part would have them.
void draw_part(MadeGround& ground, const model::Template& part, double slope_x, double slope_y,
               double angle_rad) {
  const ProjectedTemplate t = project(part, part.anchors[0], slope_x, slope_y, angle_rad,
                                      ground.made.images, ScoreConfig{});
  ground.made.for_each([&](int x, int y) {
    for (int i = 0; i < t.contour_count; ++i) {
      const int apart_px =
          std::max(std::abs(x - 30 - t.contour[i].dx), std::abs(y - 30 - t.contour[i].dy));
      for (int k = -1; k <= 1; ++k) {  // edges go into neighbouring octants as well
        const auto octant = static_cast<std::size_t>(t.contour[i].octant + k + 8) % 8;
        std::uint8_t& edge = ground.made.edge[octant](x, y);
        edge = static_cast<std::uint8_t>(std::min<int>(edge, 3 * apart_px));
      }
    }
  });
  ground.made.spread_all();
}

TEST(GridSearch, FindsASteepPartAtItsPlaceForAlmostNothing) {
  const auto part = plate(36.0, 24.0);
  GridSearchConfig config;
  config.angle_step_rad = kPi / 24;
  for (const auto& [sx, sy] : {std::pair{0.74, 0.66},
                               {-0.66, 0.74},
                               {0.74, -0.74},
                               {0.0, -1.14},
                               {1.06, 0.0},
                               {-0.34, -0.26},
                               {1.7, 0.5}}) {  // beyond 60 degrees: the edge factor is at its limit
    for (const int angle_index : {0, 5, 13}) {
      SCOPED_TRACE(testing::Message() << sx << ' ' << sy << ' ' << angle_index);
      MadeGround ground(60, 60, {1, 30});
      ground.lay_plane(sx, sy);
      draw_part(ground, *part, sx, sy, kPi * angle_index / 24);
      ground.collect({.max_tilt_rad = 1.2});
      const Found found = ground.run(*part, config);
      ASSERT_FALSE(found.candidates.empty());
      const Candidate& best = found.candidates[0];
      EXPECT_NEAR(best.column, 30, 1);
      EXPECT_NEAR(best.row, 30, 1);
      EXPECT_NEAR(best.angle_index, angle_index, 1);
      EXPECT_LT(best.cost_q10, 1024 / 8);
    }
  }
}

}  // namespace
}  // namespace flatpose::search
