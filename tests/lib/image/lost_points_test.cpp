#include "flatpose/image/lost_points.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

Image<std::uint8_t> lost_at_random(double share, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  return Image<std::uint8_t>::of(400, 300, [&](int, int) { return u(generator) < share ? 1 : 0; });
}

TEST(LostShare, IsThatOfTheDraw) {
  for (const double share : {0.002, 0.01, 0.05, 0.1, 0.15}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      EXPECT_NEAR(lost_share(lost_at_random(share, seed).view()), share, 0.1 * share + 0.0005)
          << seed;
    }
  }
  EXPECT_GT(lost_share(lost_at_random(0.2, 1).view()), 0.15);
}

TEST(LostShare, IsNoughtWhereAllIsSeenAndWhereWholePlacesAreDark) {
  EXPECT_EQ(lost_share(Image<std::uint8_t>(40, 30).view()), 0.0);
  EXPECT_EQ(lost_share(Image<std::uint8_t>(40, 30, 1).view()), 0.0);
  const auto dark = Image<std::uint8_t>::of(
      40, 30, [](int x, int y) { return (x > 4 && x < 15) || (y > 20 && y < 23) ? 1 : 0; });
  EXPECT_EQ(lost_share(dark.view()), 0.0);
  EXPECT_EQ(lost_share({}), 0.0);
}

TEST(AccidentalSide, GrowsWithTheShareAndTheImage) {
  EXPECT_EQ(accidental_side_px(lost_at_random(0.0, 1).view(), 3), 3);
  EXPECT_EQ(accidental_side_px(lost_at_random(0.01, 1).view(), 3), 3);
  EXPECT_EQ(accidental_side_px(lost_at_random(0.01, 1).view(), 1), 2);  // 120000 x 0.01^4
  EXPECT_EQ(accidental_side_px(lost_at_random(0.19, 1).view(), 3), 4);
  EXPECT_EQ(accidental_side_px(lost_at_random(0.0, 1).view(), 1), 1);
}

// What is promised, held against draws: fewer than one square lost in a hundred images.
TEST(AccidentalSide, IsReachedByNoAccident) {
  int square_count = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Image<std::uint8_t> lost = lost_at_random(0.15, seed);
    const int side_px = accidental_side_px(lost.view(), 2);
    for (int y = 0; y + side_px <= 300; ++y) {
      for (int x = 0; x + side_px <= 400; ++x) {
        bool all = true;
        for (int i = 0; all && i < side_px * side_px; ++i)
          all = lost(x + i % side_px, y + i / side_px) != 0;
        square_count += all ? 1 : 0;
      }
    }
  }
  EXPECT_LE(square_count, 2);
}

}  // namespace
}  // namespace flatpose::image
