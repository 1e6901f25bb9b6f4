#include "flatpose/search/grid_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/lib/search/slow_search.hpp"

namespace flatpose::search {
namespace {

/// Level ground in a few storeys with rubble between them, and random evidence.
MadeImages made_ground(std::mt19937& random, int width_px, int height_px, int evidence_levels) {
  MadeImages made(width_px, height_px);
  made.for_each([&](int x, int y) {
    const int storey = (x / 7 + y / 6) % 3;
    made.images.filled_mm(x, y) = made.field.plane_mm(x, y) = static_cast<float>(2 * storey);
    made.images.height_unit(x, y) = static_cast<std::int16_t>(2 * storey * kHeightUnitsPerMm);
    made.images.missing(x, y) = random() % 9 == 0 ? 1 : 0;
    if (x % 7 == 0 || y % 6 == 0) made.field.rms_mm(x, y) = 0.9F;
    for (const auto& channel : made.images.edge_cost) {
      channel(x, y) = static_cast<std::uint8_t>(kEdgeCostMax / (evidence_levels - 1) *
                                                integer(random, 0, evidence_levels - 1));
    }
    made.images.normal_x_unit(x, y) = static_cast<std::int8_t>(integer(random, -20, 20));
  });
  return made;
}

GridSearchConfig made_config(std::mt19937& random) {
  GridSearchConfig config;
  config.score.contour_count = 9;
  config.score.surface_count = 5;
  config.angle_step_rad = uniform(random, 0.3, 0.8);
  config.stride_px = integer(random, 1, 2);
  config.cost_share_max = 1.0;
  return config;
}

std::int32_t share_q10(std::int32_t found, const model::Template& part,
                       const GridSearchConfig& config) {
  const ProjectedTemplate t = project(part, part.anchors[0], 0, 0, 0, 1.0, config.score);
  return found * 1024 / cost_max(t, score_scale(config.score));
}

template <class Check>
void over_random_scenes(unsigned seed, int evidence_levels, const Check& check) {
  std::mt19937 random(seed);
  for (int trial = 0; trial < 60; ++trial) {
    const MadeImages made =
        made_ground(random, integer(random, 8, 22), integer(random, 8, 20), evidence_levels);
    const auto part = random_part(random, 7.0);
    part->symmetry.order = std::array{1, 2, 4, model::kFullSymmetry}[random() % 4];
    check(made, *part, made_config(random));
  }
}

TEST(GridSearch, FindsTheCheapestHypothesisThatThereIs) {
  over_random_scenes(
      1, 16,
      [](const MadeImages& made, const model::Template& part, const GridSearchConfig& config) {
        const std::vector<Hypothesis> slow = slow_search(made, part, config);
        const Found found = run(made, part, config);
        ASSERT_EQ(found.status, Status::kOk);
        ASSERT_EQ(found.result.hypothesis_count, static_cast<std::int64_t>(slow.size()));
        if (slow.empty()) return;
        ASSERT_FALSE(found.candidates.empty());
        EXPECT_EQ(found.candidates[0].cost_q10, share_q10(slow[0].cost, part, config));
      });
}

TEST(GridSearch, BreaksTiesByRowThenColumnThenAngle) {
  over_random_scenes(
      2, 2,
      [](const MadeImages& made, const model::Template& part, const GridSearchConfig& config) {
        const std::vector<Hypothesis> slow = slow_search(made, part, config);
        const Found found = run(made, part, config);
        if (slow.empty()) return;
        ASSERT_FALSE(found.candidates.empty());
        EXPECT_EQ(found.candidates[0].row, slow[0].row);
        EXPECT_EQ(found.candidates[0].column, slow[0].column);
        EXPECT_EQ(found.candidates[0].angle_index, slow[0].angle);
      });
}

TEST(GridSearch, WhereAllIsAlikeTheFirstPlaceWins) {
  const MadeImages made(15, 12);
  std::mt19937 random(3);
  auto part = random_part(random, 3.0);
  GridSearchConfig config;
  config.cost_share_max = 1.0;
  config.score.surface_count = 0;
  made.for_each([&](int x, int y) {
    for (const auto& channel : made.images.edge_cost) channel(x, y) = 8;  // as outside the field
  });
  const Found found = run(made, *part, config);
  ASSERT_FALSE(found.candidates.empty());
  EXPECT_EQ(found.candidates[0].row, 0);
  EXPECT_EQ(found.candidates[0].column, 0);
  EXPECT_EQ(found.candidates[0].angle_index, 0);
}

TEST(GridSearch, GivesEachCandidateItsTrueCost) {
  over_random_scenes(
      4, 16,
      [](const MadeImages& made, const model::Template& part, const GridSearchConfig& config) {
        const std::vector<Hypothesis> slow = slow_search(made, part, config);
        for (const Candidate& c : run(made, part, config).candidates) {
          const auto same = std::find_if(slow.begin(), slow.end(), [&](const Hypothesis& h) {
            return h.row == c.row && h.column == c.column && h.angle == c.angle_index;
          });
          ASSERT_NE(same, slow.end()) << "no hypothesis at all";
          EXPECT_EQ(c.cost_q10, share_q10(same->cost, part, config));
        }
      });
}

TEST(GridSearch, ListsCandidatesBestFirstAndNoTwoOfThemNeighbours) {
  over_random_scenes(
      5, 4,
      [](const MadeImages& made, const model::Template& part, const GridSearchConfig& config) {
        const int angles = angle_count(part.symmetry, config.angle_step_rad);
        const std::vector<Candidate> list = run(made, part, config).candidates;
        for (std::size_t i = 0; i < list.size(); ++i) {
          for (std::size_t k = i + 1; k < list.size(); ++k) {
            const Candidate& a = list[i];
            const Candidate& b = list[k];
            EXPECT_LT(std::tie(a.cost_q10, a.row, a.column, a.angle_index),
                      std::tie(b.cost_q10, b.row, b.column, b.angle_index));
            const int turn = std::abs(a.angle_index - b.angle_index);
            const bool near = std::abs(a.row - b.row) <= config.stride_px &&
                              std::abs(a.column - b.column) <= config.stride_px &&
                              std::min(turn, angles - turn) <= 1;
            EXPECT_FALSE(near) << "one of two neighbours is the better";
          }
        }
      });
}

TEST(GridSearch, WithRoomForFewGivesTheFirstOfMany) {
  over_random_scenes(
      6, 8,
      [](const MadeImages& made, const model::Template& part, const GridSearchConfig& config) {
        const std::vector<Candidate> all = run(made, part, config, 2000).candidates;
        for (const std::size_t capacity : {0U, 1U, 2U, 5U}) {
          const std::vector<Candidate> few = run(made, part, config, capacity).candidates;
          ASSERT_EQ(few.size(), std::min(capacity, all.size()));
          for (std::size_t i = 0; i < few.size(); ++i) {
            EXPECT_EQ(few[i].row, all[i].row);
            EXPECT_EQ(few[i].column, all[i].column);
            EXPECT_EQ(few[i].angle_index, all[i].angle_index);
          }
        }
      });
}

TEST(GridSearch, GivesTheSameBitsTwice) {
  over_random_scenes(
      7, 8,
      [](const MadeImages& made, const model::Template& part, const GridSearchConfig& config) {
        const std::vector<Candidate> a = run(made, part, config).candidates;
        const std::vector<Candidate> b = run(made, part, config).candidates;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
          EXPECT_EQ(a[i].cost_q10, b[i].cost_q10);
          EXPECT_EQ(a[i].work_T_object.rotation.m, b[i].work_T_object.rotation.m);
          EXPECT_EQ(a[i].work_T_object.position_mm, b[i].work_T_object.position_mm);
        }
      });
}

TEST(GridSearch, TakesOnlyHypothesesBelowTheCutOff) {
  over_random_scenes(
      8, 16, [](const MadeImages& made, const model::Template& part, GridSearchConfig config) {
        const std::vector<Hypothesis> slow = slow_search(made, part, config);
        if (slow.empty()) return;
        config.cost_share_max = 0.45;
        const std::int32_t limit_q10 = 461;  // 0.45 of 1024
        const std::vector<Candidate> list = run(made, part, config).candidates;
        for (const Candidate& c : list) EXPECT_LT(c.cost_q10, limit_q10);
        const std::int32_t best_q10 = share_q10(slow[0].cost, part, config);
        if (best_q10 > limit_q10) {
          EXPECT_TRUE(list.empty());
        }
        if (best_q10 < limit_q10 - 10) {
          EXPECT_FALSE(list.empty());
        }
      });
}

// The pose of a candidate is the hypothesis: the anchor on the plane at its place, z along the
// plane's normal, turned by its angle.
TEST(GridSearch, GivesPosesThatLieOnTheSurface) {
  for (const auto& [sx, sy] : {std::pair{0.0, 0.0}, {0.3, -0.2}, {-0.6, 0.45}}) {
    MadeImages made(30, 26, 1.5);
    made.images.grid.x0_mm = -11.0;
    made.images.grid.y0_mm = 4.0;
    std::mt19937 random(9);
    made.randomise(random, 60);
    made.for_each([&, a = sx, b = sy](int x, int y) {
      made.field.slope_x(x, y) = static_cast<float>(a);
      made.field.slope_y(x, y) = static_cast<float>(b);
      made.field.plane_mm(x, y) = static_cast<float>(1.5 * (a * x + b * y) + 100.0);
    });
    made.images.base_mm = 100.0;
    auto part = random_part(random, 8.0);
    part->anchors[0] = {2.5F, -1.5F, 3.0F};
    GridSearchConfig config;
    config.angle_step_rad = 0.4;
    config.cost_share_max = 1.0;
    const Found found = run(made, *part, config);
    ASSERT_FALSE(found.candidates.empty());
    const int angles = angle_count(part->symmetry, config.angle_step_rad);
    for (const Candidate& c : found.candidates) {
      const Vec3 anchor_mm = c.work_T_object * Vec3{2.5, -1.5, 0.0};
      EXPECT_NEAR(anchor_mm.x, -11.0 + 1.5 * c.column, 1e-9);
      EXPECT_NEAR(anchor_mm.y, 4.0 + 1.5 * c.row, 1e-9);
      EXPECT_NEAR(anchor_mm.z, made.field.plane_mm(c.column, c.row), 1e-9);
      const Rotation& r = c.work_T_object.rotation;
      EXPECT_NEAR(norm(r.column(2) - normalized({-sx, -sy, 1.0})), 0.0, 1e-6);
      const Rotation turn = tilt_rotation(r.column(2)).inverse() * r;
      const double angle_rad = 2.0 * kPi * c.angle_index / angles;
      EXPECT_NEAR(angle_between_rad(turn, rotation_about_z(angle_rad)), 0.0, 1e-9);
    }
  }
}

/// A steep plane with the edges of one part on it, exactly where the part would have them.
MadeImages steep_ground(const model::Template& part, double slope_x, double slope_y,
                        double angle_rad) {
  MadeImages made(60, 60);
  const ProjectedTemplate t =
      project(part, part.anchors[0], slope_x, slope_y, angle_rad, 1.0, ScoreConfig{});
  const Vec3 normal = normalized({-slope_x, -slope_y, 1.0});
  made.for_each([&](int x, int y) {
    const double z_mm = slope_x * (x - 30) + slope_y * (y - 30);
    made.field.slope_x(x, y) = static_cast<float>(slope_x);
    made.field.slope_y(x, y) = static_cast<float>(slope_y);
    made.field.plane_mm(x, y) = static_cast<float>(z_mm);
    made.images.height_unit(x, y) =
        static_cast<std::int16_t>(std::floor(z_mm * kHeightUnitsPerMm + 0.5));
    made.images.normal_x_unit(x, y) = static_cast<std::int8_t>(std::lround(normal.x * 127));
    made.images.normal_y_unit(x, y) = static_cast<std::int8_t>(std::lround(normal.y * 127));
    for (int i = 0; i < t.contour_count; ++i) {
      const int apart_px =
          std::max(std::abs(x - 30 - t.contour[i].dx), std::abs(y - 30 - t.contour[i].dy));
      for (int k = -1; k <= 1; ++k) {  // edges go into neighbouring octants as well
        std::uint8_t& edge = made.images.edge_cost[(t.contour[i].octant + k + 8) % 8](x, y);
        edge = static_cast<std::uint8_t>(std::min<int>(edge, 3 * apart_px));
      }
    }
  });
  return made;
}

// Templates are turned to the nearest of a few tilts: what that may cost is little.
TEST(GridSearch, FindsASteepPartAtItsPlaceForAlmostNothing) {
  const auto part = plate(36.0, 24.0);
  GridSearchConfig config;
  config.max_tilt_rad = 1.0;
  config.angle_step_rad = kPi / 24;
  for (const auto& [sx, sy] : {std::pair{0.74, 0.66},
                               {-0.66, 0.74},
                               {0.74, -0.74},
                               {0.0, -1.14},
                               {1.06, 0.0},
                               {-0.34, -0.26}}) {
    for (const int angle_index : {0, 5, 13}) {
      const MadeImages made = steep_ground(*part, sx, sy, kPi * angle_index / 24);
      const Found found = run(made, *part, config);
      ASSERT_FALSE(found.candidates.empty());
      const Candidate& best = found.candidates[0];
      EXPECT_NEAR(best.column, 30, 1) << sx << ' ' << sy;
      EXPECT_NEAR(best.row, 30, 1);
      EXPECT_NEAR(best.angle_index, angle_index, 1);
      EXPECT_LT(best.cost_q10, 1024 / 8) << sx << ' ' << sy << ' ' << angle_index;
    }
  }
}

}  // namespace
}  // namespace flatpose::search
