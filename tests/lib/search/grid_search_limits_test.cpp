// The angles of the grid search, its cut-off, its memory, and arguments that make no sense.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/lib/search/made_ground.hpp"

namespace flatpose::search {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Ground with nothing on it, a part, and a search that takes all that costs less than the most.
struct Ground : MadeGround {
  std::unique_ptr<model::Template> part;
  GridSearchConfig config;

  explicit Ground(int width_px = 20, int height_px = 16) : MadeGround(width_px, height_px) {
    std::mt19937 random(1);
    part = random_part(random, 5.0);
    config.score = {8, 8};
    config.cost_share_max = 1.0;
    config.angle_step_rad = 0.5;
    made.randomise(random);
  }
  [[nodiscard]] std::int64_t searched_places() const {
    return run(*part, config).result.hypothesis_count / searched_angles(*part, config);
  }
};

TEST(SearchAngles, ShareTheSectorThatSymmetryLeaves) {
  for (int order = 1; order <= 12; ++order) {
    const double range_rad = angle_range_rad({order, 0, 0}, {});
    EXPECT_NEAR(range_rad, 2.0 * kPi / order, 1e-15);
    for (const double step_rad : {0.02, 0.12, 0.25, 1.0, 10.0}) {
      const int count = angle_count(range_rad, step_rad);
      EXPECT_LE(range_rad / count, step_rad + 1e-12) << "no coarser than asked";
      if (count > 1) {
        EXPECT_GT(range_rad / (count - 1), step_rad - 1e-12) << "nor finer";
      }
    }
  }
  EXPECT_EQ(angle_count(kPi, 0.5), 7);
  EXPECT_EQ(angle_count(kPi / 2.0, 0.5), 4);
  EXPECT_EQ(angle_count(0.0, 0.01), 1);
}

TEST(SearchAngles, OfFullSymmetryAreOneAboutTheCentreAndAllAboutAnyOtherAnchor) {
  Ground ground;
  ground.part->symmetry = {model::kFullSymmetry, 3.0, -2.0};
  const auto at = [&](float x_mm, float y_mm) {
    ground.part->anchors[0] = {x_mm, y_mm, 5.0F};
    return searched_angles(*ground.part, ground.config);
  };
  EXPECT_EQ(at(0.0F, 0.0F), 13);
  EXPECT_EQ(at(3.0F, -2.6F), 13);
  EXPECT_EQ(at(3.0F, -2.4F), 1) << "within a tenth of its clearance";
  EXPECT_EQ(at(3.0F, -2.0F), 1);
  const Found found = ground.run(*ground.part, ground.config);
  EXPECT_FALSE(found.candidates.empty());
  for (const Candidate& c : found.candidates) EXPECT_EQ(c.angle_index, 0);
}

TEST(SearchAngles, AreNeverMoreThanTheLimit) {
  for (const double step_rad : {1e-3, 1e-12, std::numeric_limits<double>::denorm_min()}) {
    EXPECT_EQ(angle_count(2.0 * kPi, step_rad), kAngleCountMax);
  }
  Ground ground(3, 3);
  ground.config.angle_step_rad = 1e-9;
  EXPECT_EQ(ground.run(*ground.part, ground.config).result.hypothesis_count, 9 * kAngleCountMax);
}

TEST(GridSearchLimits, SearchesPlacesOnly) {
  Ground ground;
  EXPECT_EQ(ground.searched_places(), 20 * 16);
  ground.field.rms_mm(3, 4) = 0.51F;
  ground.field.rms_mm(5, 4) = 0.49F;
  ground.field.rms_mm(6, 4) = std::numeric_limits<float>::quiet_NaN();
  ground.collect();
  EXPECT_EQ(ground.searched_places(), 20 * 16 - 2);
  for (const Candidate& c : ground.run(*ground.part, ground.config).candidates) {
    EXPECT_FALSE(c.row == 4 && (c.column == 3 || c.column == 6));
  }
}

TEST(GridSearchLimits, WithoutAnyPlaceFindsNothing) {
  Ground ground;
  ground.collect({.planarity_mm = -1.0});
  const Found found = ground.run(*ground.part, ground.config);
  EXPECT_EQ(found.status, Status::kOk);
  EXPECT_EQ(found.result.hypothesis_count, 0);
  EXPECT_TRUE(found.candidates.empty());
}

TEST(GridSearchLimits, TakesOnlyHypothesesBelowTheCutOff) {
  Ground ground;
  std::size_t previous = std::numeric_limits<std::size_t>::max();
  for (const double share : {1.0, 0.6, 0.45, 0.3, 0.1, 0.0}) {
    ground.config.cost_share_max = share;
    const auto list = ground.run(*ground.part, ground.config).candidates;
    for (const Candidate& c : list) EXPECT_LT(c.cost_q10, share * 1024);
    EXPECT_LE(list.size(), previous);
    previous = list.size();
  }
  EXPECT_EQ(previous, 0U) << "nothing costs less than nothing";
}

// Otherwise a part that is out of reach would cost nothing anywhere.
TEST(GridSearchLimits, FindsNothingOfAPartThatIsWhollyOutOfReach) {
  Ground ground;
  ground.part->anchors[0].x_mm = 1000.0F;
  const Found found = ground.run(*ground.part, ground.config);
  EXPECT_EQ(found.status, Status::kOk);
  EXPECT_TRUE(found.candidates.empty());
}

TEST(GridSearchLimits, OfAnImageSmallerThanABlockAreNone) {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 30}, {30, 1}, {63, 2}, {64, 2}, {65, 2}}) {
    Ground ground(w, h);
    EXPECT_EQ(ground.searched_places(), w * h);
    EXPECT_FALSE(ground.run(*ground.part, ground.config).candidates.empty()) << w << 'x' << h;
  }
}

TEST(GridSearchLimits, StandsAnyHeightOfTheSurface) {
  Ground ground;
  std::mt19937 random(3);
  ground.field.for_each([&](int x, int y) {
    ground.field.plane_mm(x, y) = static_cast<float>(uniform(random, -2e6, 2e6));
  });
  ground.collect();
  EXPECT_EQ(ground.run(*ground.part, ground.config).status, Status::kOk);
}

TEST(GridSearchLimits, RefusesBadArguments) {
  Ground ground;
  Memory scratch(1 << 20);
  std::vector<Candidate> candidates(5);
  const auto status = [&](const GridSearchConfig& config, int anchor_index) {
    return grid_search(ground.made.images, ground.field.field, ground.places.places, *ground.part,
                       anchor_index, config, scratch.arena, candidates)
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
  for (const double bad : {-0.1, 1.1, kNan}) {
    EXPECT_EQ(with(&GridSearchConfig::cost_share_max, bad), Status::kInvalidArgument) << bad;
  }
}

TEST(GridSearchLimits, RefusesAFieldOrPlacesOfAnotherShape) {
  const Ground ground;
  Memory scratch(1 << 20);
  const auto status = [&](const TiltField& field, const Places& places) {
    return grid_search(ground.made.images, field, places, *ground.part, 0, ground.config,
                       scratch.arena, {})
        .status();
  };
  const TiltField& field = ground.field.field;
  EXPECT_EQ(status(field, ground.places.places), Status::kOk);
  const MadeField other(20, 15);
  EXPECT_EQ(status(other.field, ground.places.places), Status::kShapeMismatch);
  EXPECT_EQ(status(field, MadePlaces(other).places), Status::kShapeMismatch);
  const MadePlaces coarser(ground.field, {.stride_px = 2});
  EXPECT_EQ(status(field, coarser.places), Status::kShapeMismatch) << "of another lattice";
}

TEST(GridSearchLimits, TheScratchThatIsReservedSufficesExactly) {
  const Ground ground;
  std::vector<Candidate> candidates(5);
  const auto run_in = [&](std::size_t size_bytes) {
    Memory scratch(size_bytes);
    // The reserve allows for any address; here it is the best.
    Arena aligned(std::span(scratch.bytes).subspan(0, size_bytes));
    const auto result = grid_search(ground.made.images, ground.field.field, ground.places.places,
                                    *ground.part, 0, ground.config, aligned, candidates);
    EXPECT_EQ(aligned.used_bytes(), 0U);
    return result.status();
  };
  const std::size_t enough_bytes = scratch_bytes(ground.made.images.grid);
  EXPECT_EQ(run_in(enough_bytes), Status::kOk);
  EXPECT_EQ(run_in(enough_bytes - 2 * Arena::kAlignmentBytes), Status::kOutOfMemory);
  for (std::size_t size_bytes = 0; size_bytes < enough_bytes / 2; size_bytes += 4096) {
    EXPECT_EQ(run_in(size_bytes), Status::kOutOfMemory);
  }
}

}  // namespace
}  // namespace flatpose::search
