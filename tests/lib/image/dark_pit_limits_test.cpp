// What is no pit: points lost by accident, places of which nothing is known, and bad input.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "tests/lib/image/dark_map.hpp"

namespace flatpose::image {
namespace {

constexpr int kWidth_px = 200;
constexpr int kHeight_px = 150;
constexpr DarkPitConfig kConfig{1.0F, 4.0F};

/// A rough surface of which some points are lost at random, as `lost_share(x, y)` says.
template <class LostShare>
DarkMap lost_at_random(unsigned seed, const LostShare& lost_share) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  return DarkMap(map_of(
                     kWidth_px, kHeight_px, [&](int, int) { return 0.3 * u(generator); },
                     [&](int x, int y) { return u(generator) < lost_share(x, y); }),
                 kConfig);
}

TEST(DarkPit, PointsLostOneByOneMakeNone) {
  for (const double share : {0.01, 0.05, 0.2}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      const DarkMap map = lost_at_random(seed, [&](int, int) { return share; });
      EXPECT_EQ(map.pit_count(), 0) << share << " seed " << seed;
      EXPECT_EQ(map.lowered, map.filled);
    }
  }
}

TEST(DarkPit, PlacesWhereTwoOfThreeAreLostMakeNone) {
  for (const double share : {0.7, 0.8, 0.9, 0.95}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      const auto in_place = [](int x, int y) { return std::hypot(x - 100, y - 70) < 40.0; };
      const DarkMap map =
          lost_at_random(seed, [&](int x, int y) { return in_place(x, y) ? share : 0.01; });
      EXPECT_EQ(map.pit_count(), 0) << share << " seed " << seed;
    }
  }
}

TEST(DarkPit, AHoleIsToldFromLostPointsAllTheSame) {
  const auto in_hole = [](double x, double y, double radius) {
    return std::hypot(x - 100, y - 70) < radius;
  };
  for (const double share : {0.01, 0.2}) {
    const DarkMap map =
        lost_at_random(1, [&](int x, int y) { return in_hole(x, y, 12.0) ? 1.0 : share; });
    EXPECT_GT(map.pit_count(), share > 0.1 ? 300 : 420) << share;  // of 449
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        EXPECT_TRUE(!map.is_pit(x, y) || in_hole(x, y, 14.0)) << x << ' ' << y;
      }
    }
  }
}

DarkMap dark_box(int x0, int y0, int x1, int y1) {
  return DarkMap(map_of(
                     kWidth_px, kHeight_px, [](int, int) { return 5.0; },
                     [=](int x, int y) { return x >= x0 && x < x1 && y >= y0 && y < y1; }),
                 kConfig);
}

TEST(DarkPit, WhatReachesTheBorderOfTheImageIsNone) {
  constexpr int kInner = 3;  // so much of each side must have been seen
  EXPECT_EQ(dark_box(kInner, 40, 30, 60).pit_count(), (30 - kInner) * 20);
  EXPECT_EQ(dark_box(40, kInner, 60, 30).pit_count(), (30 - kInner) * 20);
  EXPECT_EQ(dark_box(170, 40, kWidth_px - kInner, 60).pit_count(), (30 - kInner) * 20);
  EXPECT_EQ(dark_box(40, 120, 60, kHeight_px - kInner).pit_count(), (30 - kInner) * 20);
  for (int outer = 0; outer < kInner; ++outer) {
    EXPECT_EQ(dark_box(outer, 40, 30, 60).pit_count(), 0);
    EXPECT_EQ(dark_box(40, outer, 60, 30).pit_count(), 0);
    EXPECT_EQ(dark_box(170, 40, kWidth_px - outer, 60).pit_count(), 0);
    EXPECT_EQ(dark_box(40, 120, 60, kHeight_px - outer).pit_count(), 0);
  }
}

TEST(DarkPit, SmallImagesHoldNoneAndHarmNothing) {
  for (int height = 1; height <= 7; ++height) {
    for (int width = 1; width <= 7; ++width) {
      for (unsigned mask = 0; mask < 100; ++mask) {
        std::mt19937 generator(mask);
        Image<float> z(width, height, 3.0F);
        for (int i = 1; i < width * height; ++i) {
          if (generator() % 3 != 0) z(i % width, i / width) = kMissing;
        }
        const DarkMap map(z, kConfig);
        EXPECT_TRUE(map.pit_count() == 0 || (width == 7 && height == 7));
      }
    }
  }
}

/// Blobs of missing cells on a surface of steps, of all kinds of sides.
Image<float> random_blobs(unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Image<float> z(64, 48);
  const double step_x = 20.0 + 20.0 * u(generator);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x)
      z(x, y) = static_cast<float>((x > step_x ? 1.5 : 0.0) + 0.6 * u(generator));
  }
  for (int blob = 0; blob < 14; ++blob) {
    const double cx = 64 * u(generator);
    const double cy = 48 * u(generator);
    const double rx = 1.0 + 8.0 * u(generator);
    const double ry = 1.0 + 8.0 * u(generator);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (std::hypot((x - cx) / rx, (y - cy) / ry) < 1.0) z(x, y) = kMissing;
      }
    }
  }
  return z;
}

TEST(DarkPit, IsTheSameSeenInAMirrorOrAcross) {
  int pit_count = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Image<float> z = random_blobs(seed);
    const auto mirrored = Image<float>::of(64, 48, [&](int x, int y) { return z(63 - x, y); });
    const auto across = Image<float>::of(48, 64, [&](int x, int y) { return z(y, x); });
    const DarkMap map(z, kConfig);
    const DarkMap in_mirror(mirrored, kConfig);
    const DarkMap turned(across, kConfig);
    pit_count += map.pit_count();
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ(in_mirror.lowered(63 - x, y), map.lowered(x, y)) << seed;
        ASSERT_EQ(turned.lowered(y, x), map.lowered(x, y)) << seed;
      }
    }
  }
  EXPECT_GT(pit_count, 1000);
}

TEST(DarkPit, NeedsWhatItReservesAndNoLess) {
  Arena measuring = Arena::measuring();
  reserve_dark_pit_scratch(measuring, 50, 40);
  std::vector<std::byte> memory(measuring.required_bytes());
  const auto lowered_in = [&](std::size_t size_bytes) {
    Image<float> z(50, 40, 1.0F);
    Image<std::uint8_t> missing(50, 40);
    Arena arena{std::span(memory).first(size_bytes)};
    const Status s = lower_dark_pits({}, arena, missing.view(), z.view());
    EXPECT_EQ(arena.used_bytes(), 0U);
    return s;
  };
  EXPECT_EQ(lowered_in(memory.size()), Status::kOk);
  EXPECT_EQ(lowered_in(0), Status::kOutOfMemory);
  EXPECT_EQ(lowered_in(50 * 40), Status::kOutOfMemory);
}

TEST(DarkPit, RefusesOtherShapesAndBadConfigs) {
  Image<float> z(50, 40, 1.0F);
  Image<std::uint8_t> missing(50, 40);
  Image<std::uint8_t> other(50, 39);
  std::vector<std::byte> memory(1U << 16U);
  Arena arena{std::span(memory)};
  EXPECT_EQ(lower_dark_pits({}, arena, other.view(), z.view()), Status::kShapeMismatch);
  for (const DarkPitConfig& bad :
       {DarkPitConfig{0.0F, 4.0F}, DarkPitConfig{-1.0F, 4.0F}, DarkPitConfig{1.0F, 1.0F},
        DarkPitConfig{kMissing, 4.0F}, DarkPitConfig{1.0F, kMissing}}) {
    EXPECT_EQ(lower_dark_pits(bad, arena, missing.view(), z.view()), Status::kInvalidArgument);
  }
  EXPECT_EQ(lower_dark_pits({}, arena, ImageView<std::uint8_t>{}, ImageView<float>{}), Status::kOk);
}

}  // namespace
}  // namespace flatpose::image
