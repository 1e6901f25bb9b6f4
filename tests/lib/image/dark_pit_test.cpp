// What is a pit, on maps drawn by hand.

#include "flatpose/image/dark_pit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "flatpose/core/maths.hpp"
#include "tests/lib/image/dark_map.hpp"

namespace flatpose::image {
namespace {

using Shape = std::function<bool(double, double)>;

Shape disc(double x, double y, double radius) {
  return [=](double px, double py) { return std::hypot(px - x, py - y) < radius; };
}

constexpr int kWidth_px = 90;
constexpr int kHeight_px = 80;
constexpr DarkPitConfig kConfig{1.0F, 4.0F};

/// Level but for a little noise, which leaves sides level.
double ground(int x, int y) { return 10.0 + 0.01 * ((x * 7 + y * 13) % 11); }

DarkMap dark_within(const Shape& is_dark) {
  return DarkMap(map_of(kWidth_px, kHeight_px, ground, is_dark), kConfig);
}

void expect_lowered_where(const DarkMap& map, const std::function<bool(int, int)>& is_pit) {
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const bool pit = is_pit(x, y);
      ASSERT_EQ(map.is_pit(x, y), pit) << x << ' ' << y;
      ASSERT_EQ(map.lowered(x, y), map.filled(x, y) - (pit ? kConfig.drop_mm : 0.0F));
    }
  }
}

TEST(DarkPit, AGapBetweenLevelSidesIsLoweredAndNothingElse) {
  const Shape gap = [](double x, double y) { return x >= 20 && x < 31 && y >= 15 && y < 22; };
  expect_lowered_where(dark_within(gap), [&](int x, int y) { return gap(x, y); });
}

TEST(DarkPit, NarrowTipsAreLoweredWithTheGapThatTheyAdjoin) {
  // Three wide along rows and columns, but a square of three fits nowhere into it.
  const auto band = [](double x, double y) {
    return (std::fabs(x - y) < 1.5 && x > 14 && x < 60) ||
           (std::fabs(x + y - 70) < 1.5 && x > 20 && x < 50);
  };
  const auto block = [](double x, double y) { return x > 29 && x < 41 && y > 29 && y < 41; };
  const DarkMap alone =
      dark_within([&](double x, double y) { return band(x, y) && x + y < 58 && x < y + 5; });
  EXPECT_EQ(alone.pit_count(), 0);
  const DarkMap map = dark_within([&](double x, double y) { return band(x, y) || block(x, y); });
  for (const int k : {18, 25, 45, 56}) EXPECT_TRUE(map.is_pit(k, k)) << k;
  for (const int x : {24, 27, 43, 46}) EXPECT_TRUE(map.is_pit(x, 70 - x)) << x;
  EXPECT_FALSE(map.is_pit(12, 12));
  EXPECT_FALSE(map.is_pit(30, 45));
}

TEST(DarkPit, AHoleWhollyDarkIsLowered) {
  for (const double radius : {4.0, 9.3, 20.0}) {
    const Shape hole = disc(41.2, 38.7, radius);
    const DarkMap map = dark_within(hole);
    // Its outermost rows and columns are too short to tell from points lost one by one.
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        if (disc(41.2, 38.7, radius - 1.5)(x, y)) {
          EXPECT_TRUE(map.is_pit(x, y)) << x << ' ' << y;
        } else if (!hole(x, y)) {
          EXPECT_FALSE(map.is_pit(x, y)) << x << ' ' << y;
        }
      }
    }
  }
}

TEST(DarkPit, TheGapsBetweenDiscsThatTouchAreLowered) {
  // Tops at 10 in rows of discs that touch; between them nothing was seen.
  constexpr double kRadius = 12.2;
  const auto on_disc = [&](double x, double y) {
    for (int row = -1; row <= 4; ++row) {
      for (int column = -1; column <= 4; ++column) {
        if (disc(8 + 24 * column, 6 + 24 * row, kRadius)(x, y)) return true;
      }
    }
    return false;
  };
  const DarkMap map = dark_within([&](double x, double y) { return !on_disc(x, y); });
  for (const int y : {18, 42}) {
    for (const int x : {20, 44, 68}) {
      for (int d = -2; d <= 2; ++d) {
        EXPECT_TRUE(map.is_pit(x + d, y)) << x << ' ' << y;
        EXPECT_TRUE(map.is_pit(x, y + d)) << x << ' ' << y;
      }
    }
  }
}

TEST(DarkPit, SidesThatAreNotLevelMakeNone) {
  const Shape gap = [](double x, double y) { return x >= 30 && x < 50 && y >= 30 && y < 50; };
  // One side after the other is raised by more than what is level.
  for (int side = 0; side < 4; ++side) {
    const auto height = [&](int x, int y) {
      const bool raised[] = {x < 30, x >= 50, y < 30, y >= 50};
      return raised[side] ? 11.2 : 10.0;
    };
    EXPECT_EQ(DarkMap(map_of(kWidth_px, kHeight_px, height, gap), kConfig).pit_count(), 0) << side;
  }
}

// What stands on the floor covers what lies behind it, as far as its shadow falls.
Shape shadow_of(const Shape& caster, double dx, double dy) {
  return [=](double x, double y) {
    if (caster(x, y)) return false;
    for (int i = 0; i <= 20; ++i) {
      if (caster(x - dx * i / 20.0, y - dy * i / 20.0)) return true;
    }
    return false;
  };
}

TEST(DarkPit, AShadowBesideItsCasterIsNone) {
  const Shape box = [](double x, double y) { return x > 32 && x < 58 && y > 30 && y < 51; };
  const Shape turned = [](double x, double y) {
    const double u = 0.9 * (x - 45) + 0.436 * (y - 40);
    const double v = -0.436 * (x - 45) + 0.9 * (y - 40);
    return std::fabs(u) < 14 && std::fabs(v) < 9;
  };
  for (const Shape& caster : {box, turned, disc(45, 40, 14)}) {
    for (const double length : {2.0, 6.0, 13.0}) {
      for (int direction = 0; direction < 16; ++direction) {
        const double a = 2.0 * kPi * direction / 16;
        const Shape shadow = shadow_of(caster, length * std::cos(a), length * std::sin(a));
        // Its flanks were not seen either.
        const auto is_dark = [&](int x, int y) {
          if (caster(x, y)) return false;
          return shadow(x, y) || caster(x - 1, y) || caster(x + 1, y) || caster(x, y - 1) ||
                 caster(x, y + 1);
        };
        const auto height = [&](int x, int y) { return caster(x, y) ? 8.0 : 0.0; };
        const DarkMap map(map_of(kWidth_px, kHeight_px, height, is_dark), kConfig);
        EXPECT_EQ(map.pit_count(), 0) << "length " << length << " direction " << direction;
      }
    }
  }
}

}  // namespace
}  // namespace flatpose::image
