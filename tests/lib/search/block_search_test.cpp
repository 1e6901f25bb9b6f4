// The vectorised loop in every form that this processor runs, against the scalar cost.

#include "flatpose/search/block_search.hpp"

#include <gtest/gtest.h>

#include "tests/lib/search/made_images.hpp"
#include "tests/lib/search/made_projection.hpp"
#include "tests/lib/search/slow_block.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::search {
namespace {

class BlockSearch : public testing::TestWithParam<VectorPath> {
 protected:
  static std::vector<ProjectedTemplate> random_angles(std::mt19937& random,
                                                      const SearchImages& images, int count) {
    std::vector<ProjectedTemplate> angles;
    for (int i = 0; i < count; ++i) angles.push_back(random_projection(random, images));
    return angles;
  }

  /// Any block of the lattice, places of `bin_count` bins mixed; beyond the last place none.
  static Block random_block(std::mt19937& random, const Lattice& lattice, int bin_count) {
    Block block;
    block.column = integer(random, 0, (lattice.width - 1) / kBlockSize) * kBlockSize;
    block.row = integer(random, 0, lattice.height - 1);
    block.wanted_bin = static_cast<std::uint16_t>(integer(random, 0, kBinCount - 1));
    block.cutoff = static_cast<std::uint8_t>(random() % 2 != 0 ? 255 : integer(random, 0, 255));
    for (int lane = 0; lane < kBlockSize; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      block.place_unit[i] = static_cast<std::uint8_t>(integer(random, 0, kHeightUnitMax));
      const bool is_place = block.column + lane < lattice.width && random() % 16 != 0;
      const int bin = block.wanted_bin + integer(random, 0, bin_count - 1);
      block.bin[i] = is_place ? static_cast<std::uint16_t>(bin) : kNoBin;
    }
    return block;
  }

  void expect_equals_scalar(const MadeImages& made, const Block& block,
                            const std::vector<ProjectedTemplate>& angles) {
    const BlockBest slow = slow_block(made.images, block, angles);
    const BlockBest fast =
        fast_block(made.images, block, all_shifted(angles, made.images), GetParam());
    for (std::size_t sector = 0; sector < kSectorCount; ++sector) {
      ASSERT_EQ(fast.cost[sector], slow.cost[sector]) << "sector " << sector;
      ASSERT_EQ(fast.angle[sector], slow.angle[sector]) << "sector " << sector;
      for (const std::uint8_t angle : slow.angle[sector])
        found_count_ += angle != kNoAngle && angle != BlockBest::kUntouched ? 1 : 0;
    }
  }

  /// Every stride, heights or normals, directions or none, every cap, sizes about a block's.
  template <class Check>
  void over_random_images(unsigned seed, int levels, const Check& check) {
    std::mt19937 random(seed);
    for (int trial = 0; trial < 64; ++trial) {
      SearchImagesConfig config;
      config.stride_px = 1 + trial % kStrideMax_px;
      config.reach_px = 1 << (random() % 5);
      config.use_height = trial / 4 % 2 == 0;
      config.use_directions = trial / 8 % 2 == 0;
      MadeImages made(integer(random, 1, 140 * config.stride_px), integer(random, 1, 12), config);
      if (config.use_height) {
        made.images.surface_cap = integer(random, 2, kSurfaceCostMax);
        made.images.surface_weight = kSurfaceCostMax / made.images.surface_cap;
      }
      made.randomise(random, levels);
      check(random, made);
      if (HasFatalFailure()) return;
    }
  }

  int found_count_ = 0;
};

TEST_P(BlockSearch, EqualsTheScalarCostOnAnyImages) {
  over_random_images(1, 256, [&](std::mt19937& random, const MadeImages& made) {
    for (const int angle_count : {1, 2, 3, 4, 5, 63}) {
      expect_equals_scalar(made, random_block(random, made.images.lattice, 2),
                           random_angles(random, made.images, angle_count));
    }
  });
  EXPECT_GT(found_count_, 10'000);
}

TEST_P(BlockSearch, EqualsTheScalarCostAtAsManyAnglesAsThereMayBe) {
  std::mt19937 random(2);
  for (const int angle_count : {720, kSectorCount * kNoAngle}) {
    MadeImages made(100, 7, {1, 16});
    made.randomise(random);
    expect_equals_scalar(made, random_block(random, made.images.lattice, 2),
                         random_angles(random, made.images, angle_count));
  }
  EXPECT_GT(found_count_, 100);
}

TEST_P(BlockSearch, TakesTheFirstAngleOfEquals) {
  over_random_images(3, 2, [&](std::mt19937& random, const MadeImages& made) {
    std::vector<ProjectedTemplate> angles = random_angles(random, made.images, 12);
    for (int copy = 0; copy < 3; ++copy)
      angles.insert(angles.end(), angles.begin(), angles.begin() + 12);
    for (auto& t : angles) {
      t.contour_count = std::min(t.contour_count, 3);
      t.surface_count = std::min(t.surface_count, 2);
    }
    expect_equals_scalar(made, random_block(random, made.images.lattice, 1), angles);
    std::shuffle(angles.begin(), angles.end(), random);
    expect_equals_scalar(made, random_block(random, made.images.lattice, 1), angles);
  });
  EXPECT_GT(found_count_, 1000);
}

TEST_P(BlockSearch, LeavesLanesOfOtherBinsUntouched) {
  std::mt19937 random(4);
  MadeImages made(64, 1, {1, 4});
  made.randomise(random);
  const auto angles = random_angles(random, made.images, 8);
  for (std::size_t wanted = 0; wanted < kBlockSize; ++wanted) {
    Block block;
    block.bin.fill(17);
    block.bin[wanted] = 16;
    block.wanted_bin = 16;
    expect_equals_scalar(made, block, angles);
  }
  Block none;
  none.bin.fill(kNoBin);
  const BlockBest best =
      fast_block(made.images, none, all_shifted(angles, made.images), GetParam());
  EXPECT_EQ(best.cost, BlockBest{}.cost);
  EXPECT_EQ(best.angle, BlockBest{}.angle);
}

TEST_P(BlockSearch, CountsOnlyCostsBelowTheCutoff) {
  // One contour point, no edge anywhere: the cost is 15 at every place.
  const MadeImages made(64, 3, {1, 4});
  std::vector<ProjectedTemplate> angles(1);
  angles[0].contour_count = 1;
  for (const int cutoff : {0, 1, 14, 15, 16, 255}) {
    Block block;
    block.place_unit.fill(100);
    block.cutoff = static_cast<std::uint8_t>(cutoff);
    const BlockBest best =
        fast_block(made.images, block, all_shifted(angles, made.images), GetParam());
    for (const std::uint8_t angle : best.angle[0]) EXPECT_EQ(angle, cutoff > 15 ? 0 : kNoAngle);
    for (const std::uint8_t angle : best.angle[3])
      EXPECT_EQ(angle, BlockBest::kUntouched) << "no angle there";
  }
}

TEST_P(BlockSearch, NeverTakesACostThatSaturates) {
  const MadeImages made(64, 3, {1, 4});
  std::vector<ProjectedTemplate> angles(1);
  angles[0].contour_count = kContourCountMax;
  Block block;
  block.place_unit.fill(100);
  EXPECT_EQ(cost(made.images, angles[0], 5, 1, 100), kCostMax);
  const BlockBest best =
      fast_block(made.images, block, all_shifted(angles, made.images), GetParam());
  for (const std::uint8_t angle : best.angle[0]) EXPECT_EQ(angle, kNoAngle);
}

/// 64 places of which each has an edge cost of its own and all the same surface cost, as normals.
struct OneOfEach {
  std::array<std::uint8_t, 3 * kBlockSize> bytes{};  // edge, normal's x, normal's y
  std::array<std::uint8_t, kBlockSize> place_unit{};
  std::array<std::uint16_t, kBlockSize> bin{};
  std::array<ShiftedTemplate, 1> angle;
  BlockJob job;

  OneOfEach() {
    angle[0].contour_count = angle[0].surface_count = 1;
    angle[0].surface[0].offset_bytes = kBlockSize;
    angle[0].surface[0].second_offset_bytes = 2 * kBlockSize;
    job.image_bytes = bytes.data();
    job.place_unit = place_unit.data();
    job.bin = bin.data();
    job.angles = angle;
    job.use_height = false;
    job.surface_cap = kCostMax;
    job.cutoff = kCostMax;
  }
  OneOfEach(const OneOfEach&) = delete;
  OneOfEach& operator=(const OneOfEach&) = delete;

  void set_edges(int first) {
    for (std::size_t i = 0; i < kBlockSize; ++i) bytes[i] = static_cast<std::uint8_t>(first + i);
  }
  void set_surface(int cost) {
    std::fill_n(bytes.begin() + kBlockSize, kBlockSize, static_cast<std::uint8_t>(cost));
  }
  /// Costs that saturate are never found, and read as the cut-off, which is the same.
  BlockBest::Lanes costs(VectorPath path) {
    BlockBest best;
    for (std::size_t sector = 0; sector < kSectorCount; ++sector) {
      job.best_cost[sector] = best.cost[sector].data();
      job.best_angle[sector] = best.angle[sector].data();
    }
    search_block_for(path)(job);
    return best.cost[0];
  }
};

TEST_P(BlockSearch, SumsEveryEdgeAndSurfaceAtEveryWeightAndTiltLikeTheScalarFormula) {
  OneOfEach one;
  for (const int weight : {1, 2, 3, 5}) {
    one.job.surface_weight = static_cast<std::uint8_t>(weight);
    for (int surface = 0; surface * weight <= kSurfaceCountMax * kSurfaceCostMax; ++surface) {
      one.set_surface(surface);
      for (int factor_q8 = 256; factor_q8 <= kEdgeFactorMax_q8; ++factor_q8) {
        one.angle[0].edge_factor_q8 = factor_q8;
        for (int first = 0; first <= kCostMax; first += kBlockSize) {
          one.set_edges(first);
          BlockBest::Lanes expected{};
          for (int i = 0; i < kBlockSize; ++i) {
            expected[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(
                std::min(surface * weight + ((first + i) * factor_q8 >> 8), kCostMax));
          }
          ASSERT_EQ(one.costs(GetParam()), expected)
              << surface << " x " << weight << ", edges from " << first << " by " << factor_q8;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, BlockSearch, testing::ValuesIn(vector_paths()),
                         testing::PrintToStringParamName());

TEST(BlockSearchPaths, AreDifferentLoopsWhereTheBuildHasThem) {
#if defined(__x86_64__)
  EXPECT_NE(search_block_for(VectorPath::kAvx2), search_block_for(VectorPath::kPortable));
  EXPECT_NE(search_block_for(VectorPath::kAvx512), search_block_for(VectorPath::kPortable));
  EXPECT_NE(search_block_for(VectorPath::kAvx512), search_block_for(VectorPath::kAvx2));
#endif
  EXPECT_EQ(search_block_for(static_cast<VectorPath>(99)), search_block_for(VectorPath::kPortable));
}

TEST(BlockSearchOffsets, OfATableAreTheLattices) {
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    for (const int reach_px : {1, 2, 5, 37, kReachMax_px - 1, kReachMax_px}) {
      const Lattice lattice = make_lattice(131, 57, stride_px, reach_px);
      const OffsetTable table(lattice);
      ASSERT_LE(lattice.reach_px(), kReachMax_px);
      for (int dy = -lattice.reach_px(); dy <= lattice.reach_px(); ++dy) {
        for (int dx = -lattice.reach_px(); dx <= lattice.reach_px(); ++dx)
          ASSERT_EQ(table.offset_bytes(dx, dy), lattice.offset_bytes(dx, dy)) << dx << ", " << dy;
      }
    }
  }
}

TEST(BlockSearchSectors, ShareTheAnglesOutEvenlyAndInOrder) {
  for (int count = 1; count <= kSectorCount * kNoAngle; ++count) {
    EXPECT_EQ(sector_begin(0, count), 0);
    EXPECT_EQ(sector_begin(kSectorCount, count), count);
    for (int sector = 0; sector < kSectorCount; ++sector) {
      const int size = sector_begin(sector + 1, count) - sector_begin(sector, count);
      EXPECT_GE(size, count / kSectorCount);
      EXPECT_LE(size, (count + kSectorCount - 1) / kSectorCount);
      EXPECT_LE(size, kNoAngle) << "an index below kNoAngle for each";
    }
  }
}

}  // namespace
}  // namespace flatpose::search
