// The gates in front of the grid search, its angles, its memory, and arguments that make no sense.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/lib/search/slow_search.hpp"

namespace flatpose::search {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Ground {
  MadeImages made{20, 16};
  std::unique_ptr<model::Template> part;
  GridSearchConfig config;

  Ground() {
    std::mt19937 random(1);
    part = random_part(random, 5.0);
    config.cost_share_max = 1.0;
    config.angle_step_rad = 0.5;
  }
  [[nodiscard]] std::int64_t places() const {
    return run(made, *part, config).result.hypothesis_count /
           angle_count(part->symmetry, config.angle_step_rad);
  }
};

TEST(SearchAngles, ShareTheSectorThatSymmetryLeaves) {
  for (int order = 1; order <= 12; ++order) {
    const model::Symmetry symmetry{order, 0, 0};
    EXPECT_NEAR(angle_range_rad(symmetry), 2.0 * kPi / order, 1e-15);
    for (const double step_rad : {0.02, 0.12, 0.25, 1.0, 10.0}) {
      const int count = angle_count(symmetry, step_rad);
      EXPECT_LE(angle_range_rad(symmetry) / count, step_rad + 1e-12) << "no coarser than asked";
      if (count > 1) {
        EXPECT_GT(angle_range_rad(symmetry) / (count - 1), step_rad - 1e-12) << "nor finer";
      }
    }
  }
  EXPECT_EQ(angle_count({2, 0, 0}, 0.5), 7);
  EXPECT_EQ(angle_count({4, 0, 0}, 0.5), 4);
}

TEST(SearchAngles, OfFullSymmetryAreOne) {
  const model::Symmetry full{model::kFullSymmetry, 0, 0};
  EXPECT_EQ(angle_range_rad(full), 0.0);
  EXPECT_EQ(angle_count(full, 0.01), 1);
  Ground ground;
  ground.part->symmetry = full;
  for (const Candidate& c : run(ground.made, *ground.part, ground.config).candidates) {
    EXPECT_EQ(c.angle_index, 0);
  }
}

TEST(SearchAngles, AreNeverMoreThanTheLimit) {
  for (const double step_rad : {1e-3, 1e-12, std::numeric_limits<double>::denorm_min()}) {
    EXPECT_EQ(angle_count({1, 0, 0}, step_rad), kAngleCountMax);
  }
}

TEST(GridSearch, SearchesPlanarPlacesOnly) {
  Ground ground;
  EXPECT_EQ(ground.places(), 20 * 16);
  ground.made.field.rms_mm(3, 4) = 0.51F;
  ground.made.field.rms_mm(5, 4) = 0.49F;
  ground.made.field.rms_mm(6, 4) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ground.places(), 20 * 16 - 2);
  for (const Candidate& c : run(ground.made, *ground.part, ground.config).candidates) {
    EXPECT_FALSE(c.row == 4 && (c.column == 3 || c.column == 6));
  }
}

TEST(GridSearch, WithoutAnyPlanarPlaceFindsNothing) {
  Ground ground;
  ground.config.planarity_mm = -1.0;
  const Found found = run(ground.made, *ground.part, ground.config);
  EXPECT_EQ(found.status, Status::kOk);
  EXPECT_EQ(found.result.hypothesis_count, 0);
  EXPECT_TRUE(found.candidates.empty());
}

TEST(GridSearch, LeavesPlacesSteeperThanTheLimitOut) {
  Ground ground;
  for (const double max_tilt_rad : {0.0, 0.2, 0.8, 1.1}) {
    ground.config.max_tilt_rad = max_tilt_rad;
    for (const double azimuth_rad : {0.0, 1.0, 2.5, -2.0}) {
      for (const double factor : {0.98, 1.02}) {
        const double slope = std::tan(max_tilt_rad) * factor + (factor > 1.0 ? 0.01 : 0.0);
        ground.made.field.slope_x(7, 7) = static_cast<float>(slope * std::cos(azimuth_rad));
        ground.made.field.slope_y(7, 7) = static_cast<float>(slope * std::sin(azimuth_rad));
        EXPECT_EQ(ground.places(), 20 * 16 - (factor > 1.0 ? 1 : 0)) << max_tilt_rad;
      }
    }
  }
}

TEST(GridSearch, StandsAnySlopeOfTheSurface) {
  Ground ground;
  std::mt19937 random(2);
  ground.config.max_tilt_rad = 1.5;
  ground.made.for_each([&](int x, int y) {
    const double slope = std::pow(10.0, uniform(random, -3, 7));
    const double azimuth_rad = uniform(random, -kPi, kPi);
    ground.made.field.slope_x(x, y) = static_cast<float>(slope * std::cos(azimuth_rad));
    ground.made.field.slope_y(x, y) = static_cast<float>(slope * std::sin(azimuth_rad));
  });
  EXPECT_EQ(run(ground.made, *ground.part, ground.config).status, Status::kOk);
}

TEST(GridSearch, StandsAnyHeightOfTheSurface) {
  Ground ground;
  std::mt19937 random(3);
  ground.config.score.height_tolerance_mm = 0.01;
  ground.made.for_each([&](int x, int y) {
    const double height_mm = uniform(random, -2e6, 2e6);
    ground.made.field.plane_mm(x, y) = static_cast<float>(height_mm);
    ground.made.images.height_unit(x, y) = height_mm > 0.0 ? 32767 : -32767;
  });
  EXPECT_EQ(run(ground.made, *ground.part, ground.config).status, Status::kOk);
}

TEST(GridSearch, TakesPlacesOfItsStrideOnly) {
  Ground ground;
  for (const int stride_px : {1, 2, 3, 7, 100}) {
    ground.config.stride_px = stride_px;
    const int across = (20 + stride_px - 1) / stride_px;
    const int down = (16 + stride_px - 1) / stride_px;
    EXPECT_EQ(ground.places(), across * down);
    for (const Candidate& c : run(ground.made, *ground.part, ground.config).candidates) {
      EXPECT_EQ(c.column % stride_px, 0);
      EXPECT_EQ(c.row % stride_px, 0);
    }
  }
}

TEST(GridSearch, RefusesBadArguments) {
  Ground ground;
  Memory scratch(1 << 20);
  std::vector<Candidate> candidates(5);
  const auto status = [&](const GridSearchConfig& config, int anchor_index) {
    return grid_search(ground.made.images, ground.made.field, *ground.part, anchor_index, config,
                       scratch.arena, candidates)
        .status();
  };
  EXPECT_EQ(status(ground.config, 0), Status::kOk);
  EXPECT_EQ(status(ground.config, -1), Status::kInvalidArgument);
  EXPECT_EQ(status(ground.config, 1), Status::kInvalidArgument) << "the part has one anchor";
  const auto with = [&](auto GridSearchConfig::*field, auto value) {
    GridSearchConfig config = ground.config;
    config.*field = value;
    return status(config, 0);
  };
  for (const double bad : {0.0, -0.1, kNan}) {
    EXPECT_EQ(with(&GridSearchConfig::angle_step_rad, bad), Status::kInvalidArgument) << bad;
  }
  for (const int bad : {0, -1}) {
    EXPECT_EQ(with(&GridSearchConfig::stride_px, bad), Status::kInvalidArgument) << bad;
  }
  // From a right angle on the tangent has another sign: nothing would bound the slopes.
  for (const double bad : {-0.1, 1.5708, 1.6, 3.0, 1e9, kNan}) {
    EXPECT_EQ(with(&GridSearchConfig::max_tilt_rad, bad), Status::kInvalidArgument) << bad;
  }
  for (const double bad : {-0.1, 1.1, kNan}) {
    EXPECT_EQ(with(&GridSearchConfig::cost_share_max, bad), Status::kInvalidArgument) << bad;
  }
}

TEST(GridSearch, RefusesAFieldOfAnotherShape) {
  Ground ground;
  const MadeImages other(20, 15);
  Memory scratch(1 << 20);
  EXPECT_EQ(grid_search(ground.made.images, other.field, *ground.part, 0, ground.config,
                        scratch.arena, {})
                .status(),
            Status::kShapeMismatch);
}

TEST(GridSearch, RefusesTooLittleScratch) {
  Ground ground;
  std::vector<Candidate> candidates(5);
  const std::size_t enough_bytes = scratch_bytes(ground.made);
  int refused = 0;
  for (std::size_t size_bytes = 0; size_bytes <= enough_bytes; size_bytes += 512) {
    Memory scratch(size_bytes);
    const auto result = grid_search(ground.made.images, ground.made.field, *ground.part, 0,
                                    ground.config, scratch.arena, candidates);
    if (result) continue;
    EXPECT_EQ(result.status(), Status::kOutOfMemory);
    EXPECT_EQ(scratch.arena.used_bytes(), 0U);
    ++refused;
  }
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace flatpose::search
