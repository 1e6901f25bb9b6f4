// What is seen at a place, against the definition: the middle one of the sorted heights, and the
// nearest.

#include "flatpose/locate/sight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace flatpose::locate {
namespace {

constexpr int kWidth_px = 9;
constexpr int kHeight_px = 7;
constexpr double kMiddle_mm = 1.0;
constexpr double kNearest_mm = 0.5;

struct Patch {
  std::vector<float> height_mm = std::vector<float>(kWidth_px * kHeight_px);
  std::vector<std::uint8_t> missing = std::vector<std::uint8_t>(kWidth_px * kHeight_px);
  refine::FineImages images;

  Patch() {
    images.grid.width_px = kWidth_px;
    images.grid.height_px = kHeight_px;
    images.grid.cell_mm = 1.0;
    images.height_mm = {height_mm.data(), kWidth_px, kHeight_px, kWidth_px};
    images.missing = {missing.data(), kWidth_px, kHeight_px, kWidth_px};
  }
  [[nodiscard]] Look at(double column, double row, double z_mm) const {
    return look(images, {images.grid.x0_mm + column, images.grid.y0_mm + row, z_mm}, kMiddle_mm,
                kNearest_mm);
  }
};

Sight by_tolerance(double above_mm, double tolerance_mm) {
  if (above_mm > tolerance_mm) return Sight::kAbove;
  return above_mm < -tolerance_mm ? Sight::kBelow : Sight::kAt;
}

Look by_sorting(const Patch& patch, int column, int row, double z_mm) {
  std::vector<double> above_mm;
  for (int y = row - 1; y <= row + 1; ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      if (x < 0 || y < 0 || x >= kWidth_px || y >= kHeight_px) continue;
      const double value = static_cast<double>(patch.height_mm[y * kWidth_px + x]) - z_mm;
      if (!std::isnan(value)) above_mm.push_back(value);
    }
  }
  if (above_mm.empty()) return {};
  const double nearest =
      *std::min_element(above_mm.begin(), above_mm.end(),
                        [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  std::sort(above_mm.begin(), above_mm.end());
  return {by_tolerance(above_mm[above_mm.size() / 2], kMiddle_mm),
          by_tolerance(nearest, kNearest_mm)};
}

TEST(Sight, IsTheMiddleAndTheNearestOfTheCellsAround) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> height(-3.0F, 3.0F);
  std::bernoulli_distribution lost(0.3);
  for (int round = 0; round < 200; ++round) {
    Patch patch;
    for (std::size_t i = 0; i < patch.height_mm.size(); ++i) {
      const bool is_lost = lost(random);
      patch.height_mm[i] = is_lost ? std::numeric_limits<float>::quiet_NaN() : height(random);
      patch.missing[i] = is_lost ? 1 : 0;
    }
    for (int row = 0; row < kHeight_px; ++row) {
      for (int column = 0; column < kWidth_px; ++column) {
        const Look want = by_sorting(patch, column, row, 0.25);
        const Look got = patch.at(column + 0.3, row - 0.3, 0.25);
        if (want.middle == Sight::kNothing) continue;  // the dark is looked into farther than 3x3
        ASSERT_EQ(got.middle, want.middle) << round << ": " << column << ", " << row;
        ASSERT_EQ(got.nearest, want.nearest) << round << ": " << column << ", " << row;
      }
    }
  }
}

TEST(Sight, OutOfTheMapIsNothing) {
  const Patch patch;
  for (const double far : {-1e9, -2.0, 20.0, 1e9}) {
    EXPECT_EQ(patch.at(far, 3, 0).middle, Sight::kNothing);
    EXPECT_EQ(patch.at(4, far, 0).nearest, Sight::kNothing);
  }
}

TEST(Sight, ADarkPitIsLower) {
  Patch patch;
  for (int y = 2; y <= 4; ++y) {
    for (int x = 3; x <= 5; ++x) {
      patch.height_mm[y * kWidth_px + x] = std::numeric_limits<float>::quiet_NaN();
      patch.missing[y * kWidth_px + x] = 2;
    }
  }
  EXPECT_EQ(patch.at(4, 3, 0.0).middle, Sight::kBelow);
  EXPECT_EQ(patch.at(4, 3, 0.0).nearest, Sight::kBelow);
  // Beside something higher the dark is a shadow.
  patch.height_mm[3 * kWidth_px + 6] = 8.0F;
  EXPECT_EQ(patch.at(4, 3, 0.0).middle, Sight::kNothing);
}

}  // namespace
}  // namespace flatpose::locate
