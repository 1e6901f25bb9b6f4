// The gate, the bins and the blocks against a cell-by-cell reading of the field.

#include "flatpose/search/places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "flatpose/core/maths.hpp"
#include "tests/lib/search/made_field.hpp"
#include "tests/lib/search/made_images.hpp"

namespace flatpose::search {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Ground of all slopes and heights, some of it rubble, some of it unknown.
void randomise(std::mt19937& random, MadeField& made, double slope_max) {
  made.for_each([&](int x, int y) {
    made.set_slope(x, y, uniform(random, 0.0, slope_max), uniform(random, -kPi, kPi));
    made.plane_mm(x, y) = static_cast<float>(uniform(random, -50.0, 900.0));
    made.rms_mm(x, y) = static_cast<float>(uniform(random, 0.0, 1.0));
    if (random() % 10 == 0)
      made.slope_x(x, y) = made.slope_y(x, y) = made.plane_mm(x, y) = made.rms_mm(x, y) = kNan;
  });
}

struct Expected {
  std::map<std::pair<int, int>, int> bin;      // by row, column
  std::set<std::tuple<int, int, int>> blocks;  // bin, row, first column
  double low_mm = std::numeric_limits<double>::infinity();
  double high_mm = -std::numeric_limits<double>::infinity();
};

Expected slow_places(MadeField& made, const PlaceConfig& config) {
  Expected expected;
  const double limit = std::min(std::tan(config.max_tilt_rad), 24 * 0.08);
  made.for_each([&](int x, int y) {
    if (x % config.stride_px != 0 || y % config.stride_px != 0) return;
    if (std::isnan(made.rms_mm(x, y)) || made.rms_mm(x, y) > config.planarity_mm) return;
    if (std::hypot(made.slope_x(x, y), made.slope_y(x, y)) > limit) return;
    const int across = static_cast<int>(std::lround(made.slope_x(x, y) / 0.08)) + 24;
    const int down = static_cast<int>(std::lround(made.slope_y(x, y) / 0.08)) + 24;
    const int column = x / config.stride_px;
    const int row = y / config.stride_px;
    expected.bin[{row, column}] = down * 49 + across;
    expected.blocks.insert({down * 49 + across, row, column / 64 * 64});
    expected.low_mm = std::min<double>(expected.low_mm, made.plane_mm(x, y));
    expected.high_mm = std::max<double>(expected.high_mm, made.plane_mm(x, y));
  });
  return expected;
}

template <class Check>
void over_random_fields(unsigned seed, const Check& check) {
  std::mt19937 random(seed);
  for (int trial = 0; trial < 60; ++trial) {
    MadeField made(integer(random, 1, 150), integer(random, 1, 30));
    randomise(random, made, std::array{0.05, 0.5, 3.0}[random() % 3]);
    PlaceConfig config;
    config.stride_px = 1 + trial % kStrideMax_px;
    config.max_tilt_rad = uniform(random, 0.0, 1.5);
    config.planarity_mm = uniform(random, 0.1, 1.2);
    check(made, config);
  }
}

TEST(Places, ArePlanarCellsOfTheStrideThatLeanNoMoreThanAllowed) {
  over_random_fields(1, [](MadeField& made, const PlaceConfig& config) {
    const Expected expected = slow_places(made, config);
    const MadePlaces found(made, config);
    const Places& places = found.places;
    ASSERT_EQ(places.place_count, static_cast<std::int64_t>(expected.bin.size()));
    for (int row = -1; row <= places.height; ++row) {
      for (int column = -1; column <= places.padded_width; ++column) {
        const auto at = expected.bin.find({row, column});
        ASSERT_EQ(places.is_place(column, row), at != expected.bin.end());
        if (at != expected.bin.end()) {
          ASSERT_EQ(places.bin[places.index(column, row)], at->second);
        }
      }
    }
  });
}

TEST(Places, HaveNoBinInTheRestOfTheLastBlock) {
  over_random_fields(2, [](MadeField& made, const PlaceConfig& config) {
    MadePlaces found(made.slope_x.width(), made.slope_x.height());
    std::fill(found.places.bin.begin(), found.places.bin.end(), std::uint16_t{7});
    ASSERT_EQ(collect_places(made.field, config, found.places), Status::kOk);
    const Places& places = found.places;
    EXPECT_EQ(places.padded_width % kBlockSize, 0);
    for (int row = 0; row < places.height; ++row) {
      for (int column = places.width; column < places.padded_width; ++column)
        ASSERT_EQ(places.bin[places.index(column, row)], kNoBin);
    }
  });
}

TEST(Places, AreListedInBlocksByBinRowAndColumnEachOnce) {
  over_random_fields(3, [](MadeField& made, const PlaceConfig& config) {
    const Expected expected = slow_places(made, config);
    const MadePlaces found(made, config);
    const Places& places = found.places;
    ASSERT_EQ(places.bin_begin[0], 0);
    ASSERT_EQ(places.bin_begin[kBinCount], static_cast<int>(expected.blocks.size()));
    int i = 0;
    for (const std::tuple<int, int, int>& block : expected.blocks) {
      const PlaceBlock& listed = places.blocks[static_cast<std::size_t>(i)];
      const std::tuple<int, int, int> found_block(listed.bin, listed.row, listed.column);
      ASSERT_EQ(found_block, block);
      ASSERT_LE(places.bin_begin[listed.bin], i);
      ASSERT_GT(places.bin_begin[listed.bin + 1], i);
      ++i;
    }
  });
}

TEST(Places, TellTheRangeOfTheirHeights) {
  over_random_fields(4, [](MadeField& made, const PlaceConfig& config) {
    const Expected expected = slow_places(made, config);
    const MadePlaces found(made, config);
    if (expected.bin.empty()) return;
    EXPECT_EQ(found.places.range.low_mm, expected.low_mm);
    EXPECT_EQ(found.places.range.high_mm, expected.high_mm);
  });
}

TEST(Places, LeaveNothingOfAnEarlierCallBehind) {
  std::mt19937 random(5);
  MadeField made(70, 9);
  randomise(random, made, 0.5);
  MadePlaces found(made, {});
  ASSERT_GT(found.places.place_count, 100);
  ASSERT_EQ(collect_places(made.field, {.planarity_mm = -1.0}, found.places), Status::kOk);
  EXPECT_EQ(found.places.place_count, 0);
  EXPECT_EQ(found.places.bin_begin[kBinCount], 0);
  EXPECT_EQ(found.places.range.low_mm, 0.0);
  EXPECT_EQ(found.places.range.high_mm, 0.0);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 70; ++column) EXPECT_FALSE(found.places.is_place(column, row));
  }
}

TEST(Places, BinsAreCentredOnTheirSlopes) {
  for (const double slope_x : {-1.92, -0.08, 0.0, 0.04 - 1e-6, 0.24, 1.92}) {
    for (const double slope_y : {-0.5, -0.04 + 1e-6, 0.0, 0.16}) {
      MadeField made(1, 1);
      made.slope_x(0, 0) = static_cast<float>(slope_x);
      made.slope_y(0, 0) = static_cast<float>(slope_y);
      const MadePlaces found(made, {.max_tilt_rad = 1.56});
      if (std::hypot(slope_x, slope_y) > 1.92) {
        EXPECT_EQ(found.places.place_count, 0) << "beyond the bins";
        continue;
      }
      const int bin = found.places.bin[0];
      ASSERT_LT(bin, kBinCount);
      EXPECT_NEAR(slope_x_of_bin(bin), slope_x, 0.5 * kSlopeBin);
      EXPECT_NEAR(slope_y_of_bin(bin), slope_y, 0.5 * kSlopeBin);
    }
  }
}

// Beyond about 62 degrees there is no bin: such places are none, whatever tilt is allowed.
TEST(Places, StandAnySlopeAndAnyAllowedTilt) {
  std::mt19937 random(6);
  MadeField made(80, 20);
  made.for_each([&](int x, int y) {
    made.set_slope(x, y, std::pow(10.0, uniform(random, -3, 7)), uniform(random, -kPi, kPi));
  });
  made.slope_x(3, 3) = std::numeric_limits<float>::infinity();
  for (const double max_tilt_rad : {0.0, 1.05, 1.2, 1.5, 1.57}) {
    const PlaceConfig config{.max_tilt_rad = max_tilt_rad};
    const Expected expected = slow_places(made, config);
    EXPECT_EQ(MadePlaces(made, config).places.place_count,
              static_cast<std::int64_t>(expected.bin.size()));
  }
}

TEST(Places, HoldTheHeightOfTheirPlaneInTheImagesUnits) {
  over_random_fields(7, [](MadeField& made, const PlaceConfig& config) {
    SearchImages images;
    images.lattice = make_lattice(made.slope_x.width(), made.slope_x.height(), config.stride_px, 1);
    images.base_mm = 20.0;
    images.height_unit_mm = 2.5;
    MadePlaces found(made, config);
    set_heights(made.field, images, found.places);
    for (const auto& [at, bin] : slow_places(made, config).bin) {
      const double plane_mm =
          made.plane_mm(at.second * config.stride_px, at.first * config.stride_px);
      const double unit = std::clamp((plane_mm - 20.0) / 2.5, 0.0, 240.0);
      ASSERT_NEAR(found.places.height_unit[found.places.index(at.second, at.first)], unit, 0.5);
    }
  });
}

TEST(Places, RefuseBadArguments) {
  const MadeField made(20, 10);
  MadePlaces found(made);
  const auto status = [&](const PlaceConfig& config) {
    return collect_places(made.field, config, found.places);
  };
  for (const int stride_px : {0, -1, kStrideMax_px + 1, 1 << 30})
    EXPECT_EQ(status({.stride_px = stride_px}), Status::kInvalidArgument) << stride_px;
  // From a right angle on the tangent has another sign: nothing would bound the slopes.
  for (const double max_tilt_rad : {-0.1, 1.5708, 1.6, 3.0, 1e9, std::nan("")})
    EXPECT_EQ(status({.max_tilt_rad = max_tilt_rad}), Status::kInvalidArgument) << max_tilt_rad;
}

TEST(Places, RefuseAFieldLargerThanTheirMemory) {
  const MadeField made(70, 10);
  for (const auto& [w, h] : {std::pair{70, 9}, {60, 10}, {0, 0}}) {
    MadePlaces found(w, h);
    EXPECT_EQ(collect_places(made.field, {}, found.places), Status::kShapeMismatch);
  }
}

TEST(Places, OfAFieldWithoutCellsAreNone) {
  MadeField made(0, 0);
  EXPECT_EQ(MadePlaces(made).places.place_count, 0);
}

}  // namespace
}  // namespace flatpose::search
