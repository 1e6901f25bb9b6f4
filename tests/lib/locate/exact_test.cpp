// What a whole search says of itself (`is_exact`, `bound_gap`), against brute force: every
// hypothesis by the cost's definition, and the field searched piece by piece.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "flatpose/locate/features.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/workspace.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/search/score.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::locate {
namespace {

using test::Block;
using test::Locating;
using test::MadeScan;

/// The images that a search reads, made as locate() makes them.
class Ground {
 public:
  Ground(const model::Template& part, const MadeScan& scan)
      : part_(part), memory_(Locator::required_bytes(test::small_limits())), arena_(memory_) {
    const auto survey = rectify::survey(scan.view(), Pose{}, arena_);
    EXPECT_TRUE(survey);
    const double pitch_mm = std::max(survey->pitch_along_row_mm, survey->pitch_along_column_mm);
    const double cell_mm = std::max(part.cell_mm, 0.75 * pitch_mm);
    rectify::GridConfig grid_config;
    grid_config.cell_mm = cell_mm;
    grid_config.cells_max = test::small_limits().cell_count;
    const auto grid = rectify::choose_grid(*survey, grid_config);
    EXPECT_TRUE(grid);
    const double noise_mm = std::max({survey->noise_sigma_mm, 0.01 * pitch_mm, 0.02 * cell_mm});
    settings_ = derive_settings(part, {}, noise_mm, pitch_mm, cell_mm);
    EXPECT_EQ(scene::build_scene(scan.view(), frames_of_scan(true), *grid, settings_.scene, arena_,
                                 scene_),
              Status::kOk);
    work_ = take_workspace(arena_, scene_.map.grid);
    EXPECT_EQ(build_features(scene_, settings_, arena_, callers_thread, work_), Status::kOk);
  }

  struct Least {
    std::int32_t cost = std::numeric_limits<std::int32_t>::max();
    Vec3 anchor_work_mm;
    double turn_rad = 0.0;
    std::int64_t hypothesis_count = 0;
  };
  /// Every place, every angle.
  [[nodiscard]] Least least_of_all() const {
    const model::Anchor& anchor = part_.anchors[0];
    const double range_rad = search::angle_range_rad(part_.symmetry, anchor);
    const int angles = search::angle_count(range_rad, settings_.search.angle_step_rad);
    Least least;
    for (int row = 0; row < work_.places.height; ++row) {
      for (int column = 0; column < work_.places.width; ++column) {
        if (!work_.places.is_place(column, row)) continue;
        for (int i = 0; i < angles; ++i) try_one(column, row, range_rad * i / angles, least);
      }
    }
    return least;
  }

  [[nodiscard]] double angle_step_rad() const { return settings_.search.angle_step_rad; }

 private:
  void try_one(int column, int row, double turn_rad, Least& least) const {
    const std::size_t place = work_.places.index(column, row);
    const int bin = work_.places.bin[place];
    const search::ProjectedTemplate projected = search::project(
        part_, part_.anchors[0], search::slope_x_of_bin(bin), search::slope_y_of_bin(bin), turn_rad,
        work_.coarse, settings_.search.score);
    const int stride_px = work_.coarse.lattice.stride_px;
    const int x = column * stride_px;
    const int y = row * stride_px;
    const std::int32_t cost =
        search::cost(work_.coarse, projected, x, y, work_.places.height_unit[place]);
    ++least.hypothesis_count;
    if (cost >= least.cost) return;
    least.cost = cost;
    least.anchor_work_mm = {work_.coarse.grid.x_of(x), work_.coarse.grid.y_of(y),
                            work_.tilt.plane_mm(x, y)};
    least.turn_rad = turn_rad;
  }

  const model::Template& part_;
  std::vector<std::byte> memory_;
  Arena arena_;
  Settings settings_;
  scene::Scene scene_;
  Workspace work_;
};

/// The part in any turn among others of like size.
std::vector<Block> among_others(int i) {
  return {{test::pose_at(45.0 + i, 40.0 + 2.0 * i, 10.0 + i, 0.7 * i)},
          {test::pose_at(110, 40, 12, 0.4 * i), 38.0, 38.0},
          {test::pose_at(100, 90, 14, 0.5 * i), 64.0, 24.0}};
}

TEST(Exact, TheBestMatchIsWhereTheLeastOfAllHypothesesIs) {
  const model::Template part = test::block_part();
  Locating locating;
  for (int i = 0; i < 6; ++i) {
    const MadeScan scan = test::bin_scan(among_others(i));
    ASSERT_EQ(locating.run(part, scan.view()), Status::kOk);
    const LocateResult& found = locating.result;
    ASSERT_EQ(found.match_count, 1) << i;
    EXPECT_TRUE(found.is_exact);
    EXPECT_EQ(found.bound_gap, 0.0);
    const Ground ground(part, scan);
    const Ground::Least least = ground.least_of_all();
    EXPECT_EQ(found.hypothesis_count, least.hypothesis_count) << i;
    // Within the steps of places and angles that the refinement starts from.
    const Pose& pose = found.matches[0].face_T_object;
    EXPECT_LT(norm(pose.position_mm - least.anchor_work_mm), 4.0) << i;
    const double turn_rad = arc_tangent(pose.rotation.m[3], pose.rotation.m[0]) - least.turn_rad;
    EXPECT_NEAR(turn_rad - kPi * std::round(turn_rad / kPi), 0.0, 2.0 * ground.angle_step_rad())
        << i;
  }
}

/// A square of the field, as a region of where the origin may lie.
Region square(double x_mm, double y_mm, double side_mm) {
  Region region;
  region.kind = Region::Kind::kBox;
  region.vertex_x_mm = {x_mm, x_mm + side_mm};
  region.vertex_y_mm = {y_mm, y_mm + side_mm};
  region.vertex_count = 2;
  return region;
}

double best_score(const LocateResult& result) {
  double best = 0.0;
  for (const Match& m : result.found()) best = std::max(best, m.score);
  return best;
}

TEST(Exact, NoPieceOfTheFieldHoldsABetterMatch) {
  const model::Template part = test::block_part();
  // One whole, one with a corner off, one narrower.
  const MadeScan scan = test::bin_scan({{test::pose_at(35, 30, 10, 0.3), 50.0, 26.0},
                                        {test::pose_at(110, 35, 22, 1.2)},
                                        {test::pose_at(50, 85, 16, 2.5), 46.0, 30.0}});
  LocateConfig config;
  config.min_score = 0.4;
  config.max_matches = 5;
  Locating locating;
  ASSERT_EQ(locating.run(part, scan.view(), config), Status::kOk);
  ASSERT_TRUE(locating.result.is_exact);
  const int whole_count = locating.result.match_count;
  const double whole_best = best_score(locating.result);
  config.max_matches = 1;
  ASSERT_EQ(locating.run(part, scan.view(), config), Status::kOk);
  const double first_best = best_score(locating.result);
  constexpr double kSide_mm = 25.0;
  double pieces_best = 0.0;
  int pieces_count = 0;
  config.max_matches = 5;
  for (double y = 0.0; y < 120.0; y += kSide_mm) {
    for (double x = 0.0; x < 150.0; x += kSide_mm) {
      config.region = square(x, y, kSide_mm);
      ASSERT_EQ(locating.run(part, scan.view(), config), Status::kOk);
      EXPECT_TRUE(locating.result.is_exact);
      pieces_count += locating.result.match_count;
      pieces_best = std::max(pieces_best, best_score(locating.result));
    }
  }
  // A piece is laid onto another grid.
  EXPECT_GE(whole_best, pieces_best - 0.02);
  EXPECT_GE(first_best, pieces_best - 0.02);
  EXPECT_EQ(whole_count, pieces_count);
}

}  // namespace
}  // namespace flatpose::locate
