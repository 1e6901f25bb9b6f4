// The grid search against every hypothesis that there is.

#include "flatpose/search/grid_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "tests/lib/search/made_ground.hpp"
#include "tests/lib/search/slow_search.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::search {
namespace {

void expect_same(const std::vector<Candidate>& found, const std::vector<Candidate>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_EQ(found[i].row, expected[i].row);
    ASSERT_EQ(found[i].column, expected[i].column);
    ASSERT_EQ(found[i].angle_index, expected[i].angle_index);
    ASSERT_EQ(found[i].cost_q10, expected[i].cost_q10);
    ASSERT_EQ(found[i].anchor, 0);
  }
}

void expect_equals_slow_search(unsigned seed, double slope_max, int levels) {
  std::size_t count = 0;
  over_random_grounds(
      seed, slope_max, levels,
      [&](const MadeGround& ground, const model::Template& part, const GridSearchConfig& config) {
        const SlowSearch slow(ground.made.images, ground.field.field, ground.places.places, part,
                              config);
        const Found found = ground.run(part, config);
        ASSERT_EQ(found.status, Status::kOk);
        EXPECT_EQ(found.result.hypothesis_count, ground.places.places.place_count * slow.angles());
        expect_same(found.candidates, slow.candidates());
        count += found.candidates.size();
      });
  EXPECT_GT(count, 100U);
}

TEST(GridSearch, FindsAllLocalMinimaOnLevelGround) { expect_equals_slow_search(1, 0.0, 256); }

TEST(GridSearch, FindsAllLocalMinimaOnSlopedGround) {
  expect_equals_slow_search(2, 0.3, 256);
  expect_equals_slow_search(3, 1.9, 256);
}

TEST(GridSearch, BreaksTiesByRowThenColumnThenAngle) {
  expect_equals_slow_search(4, 0.0, 2);
  expect_equals_slow_search(5, 0.5, 2);
}

TEST(GridSearch, WhereAllIsAlikeTheFirstPlaceWins) {
  MadeGround ground(150, 12);
  std::mt19937 random(6);
  const auto part = random_part(random, 3.0);
  GridSearchConfig config;
  config.score.surface_count = 0;
  ground.made.for_each([&](int x, int y) {
    for (auto& channel : ground.made.edge) channel(x, y) = kEdgeCostUnknown;
  });
  ground.made.spread_all();
  const Found found = ground.run(*part, config);
  ASSERT_FALSE(found.candidates.empty());
  EXPECT_EQ(found.candidates[0].row, 0);
  EXPECT_EQ(found.candidates[0].column, 0);
  EXPECT_EQ(found.candidates[0].angle_index, 0);
}

TEST(GridSearch, ListsNoTwoNeighboursThatDifferLittleInAngle) {
  over_random_grounds(
      7, 0.3, 4,
      [](const MadeGround& ground, const model::Template& part, const GridSearchConfig& config) {
        const int angles = searched_angles(part, config);
        const int reach_px = 2 * ground.made.images.lattice.stride_px;
        const auto list = ground.run(part, config).candidates;
        for (std::size_t i = 0; i < list.size(); ++i) {
          for (std::size_t k = i + 1; k < list.size(); ++k) {
            const int turn = std::abs(list[i].angle_index - list[k].angle_index);
            EXPECT_FALSE(std::abs(list[i].row - list[k].row) <= reach_px &&
                         std::abs(list[i].column - list[k].column) <= reach_px &&
                         std::min(turn, angles - turn) <= 2);
          }
        }
      });
}

TEST(GridSearch, WithRoomForFewGivesTheFirstOfMany) {
  over_random_grounds(
      8, 0.3, 8,
      [](const MadeGround& ground, const model::Template& part, const GridSearchConfig& config) {
        const std::vector<Candidate> all = ground.run(part, config).candidates;
        for (const std::size_t capacity : {0U, 1U, 2U, 5U}) {
          std::vector<Candidate> first = all;
          first.resize(std::min(capacity, all.size()));
          expect_same(ground.run(part, config, capacity).candidates, first);
        }
      });
}

TEST(GridSearch, GivesTheSameBitsOnEveryVectorPathAndTwice) {
  over_random_grounds(
      9, 0.6, 16,
      [](const MadeGround& ground, const model::Template& part, GridSearchConfig config) {
        const Found first = ground.run(part, config);
        for (const VectorPath path : vector_paths()) {
          config.vector_path = path;
          const Found again = ground.run(part, config);
          expect_same(again.candidates, first.candidates);
          for (std::size_t i = 0; i < first.candidates.size(); ++i) {
            const Pose& a = first.candidates[i].work_T_object;
            const Pose& b = again.candidates[i].work_T_object;
            ASSERT_EQ(a.rotation.m, b.rotation.m);
            ASSERT_EQ(a.position_mm.x, b.position_mm.x);
            ASSERT_EQ(a.position_mm.y, b.position_mm.y);
            ASSERT_EQ(a.position_mm.z, b.position_mm.z);
          }
        }
      });
}

/// The last chunk first.
class Backwards final : public Executor {
 public:
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    for (int i = chunk_count - 1; i >= 0; --i) task(context, i);
  }
};

/// A thread for every chunk.
class ThreadEach final : public Executor {
 public:
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    std::vector<std::thread> threads;
    for (int i = 0; i < chunk_count; ++i) threads.emplace_back(task, context, i);
    for (std::thread& thread : threads) thread.join();
  }
};

TEST(GridSearch, GivesTheSameBitsWhoeverRunsItsChunks) {
  Backwards backwards;
  ThreadEach thread_each;
  over_random_grounds(
      10, 0.6, 16,
      [&](const MadeGround& ground, const model::Template& part, const GridSearchConfig& config) {
        const Found first = ground.run(part, config);
        for (Executor* executor :
             {static_cast<Executor*>(&backwards), static_cast<Executor*>(&thread_each)}) {
          const Found again = ground.run(part, config, 2000, *executor);
          expect_same(again.candidates, first.candidates);
          EXPECT_EQ(again.result.evaluated_count, first.result.evaluated_count);
        }
      });
}

/// Bare ground with an edge here and there, as scans are: what bounds are good for.
void strew_edges(std::mt19937& random, MadeGround& ground) {
  MadeImages& made = ground.made;
  ground.lay_plane(uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2));
  for (auto& channel : made.edge) {
    {
      const int at_x = integer(random, 0, made.width() - 1);
      const int at_y = integer(random, 0, made.height_px() - 1);
      made.for_each([&](int x, int y) {
        const int cost = 3 * std::max(std::abs(x - at_x), std::abs(y - at_y));
        channel(x, y) = static_cast<std::uint8_t>(std::min<int>(channel(x, y), cost));
      });
    }
  }
  for (int i = 0; i < 6; ++i) {
    made.height(integer(random, 0, made.width() - 1), integer(random, 0, made.height_px() - 1)) =
        kHeightUnitMax;
  }
  made.spread_all();
  ground.collect();
}

TEST(GridSearch, IsTheSameWhereBoundsSpareMostOfIt) {
  std::mt19937 random(11);
  std::int64_t all = 0, looked_at = 0, found_count = 0;
  for (int trial = 0; trial < 18; ++trial) {
    SearchImagesConfig images{1 + trial % 3, 14};
    images.node_side = trial / 3 % 2 == 0 ? 2 : 4;
    images.node_slack = images.stride_px == 1 ? trial / 6 % 3 : 0;
    images.use_directions = trial % 5 != 0;
    MadeGround ground(integer(random, 150, 300), integer(random, 12, 30), images);
    strew_edges(random, ground);
    const auto part = random_part(random, 8.0);
    GridSearchConfig config;
    config.score = {integer(random, 10, 16), integer(random, 0, 4)};
    config.angle_step_rad = images.node_slack > 0 ? 0.1 : 0.5;
    config.cost_share_max = uniform(random, 0.4, 0.7);
    const SlowSearch slow(ground.made.images, ground.field.field, ground.places.places, *part,
                          config);
    for (const VectorPath path : vector_paths()) {
      config.vector_path = path;
      const Found found = ground.run(*part, config);
      expect_same(found.candidates, slow.candidates());
      all += found.result.hypothesis_count;
      looked_at += found.result.evaluated_count;
      found_count += found.result.candidate_count;
    }
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_LT(looked_at, all * 2 / 3) << "else this tests little";
  EXPECT_GT(looked_at, all / 100);
  EXPECT_GT(found_count, 100);
}

}  // namespace
}  // namespace flatpose::search
