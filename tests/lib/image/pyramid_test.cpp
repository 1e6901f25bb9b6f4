#include "flatpose/image/pyramid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

TEST(Halve, EqualsBruteForceWithMissingCellsAtEverySize) {
  constexpr float kJump_mm = 2.5F;
  for (int h = 1; h <= 7; ++h) {
    for (int w = 1; w <= 7; ++w) {
      Image<float> fine = random_image(w, h, static_cast<unsigned>(10 * w + h));
      for (int i = 0; i < w * h; ++i) {
        if (fine(i % w, i / w) < -2.0F) fine(i % w, i / w) = kMissing;
      }
      Image<float> coarse(halved(w), halved(h));
      ASSERT_EQ(halve(fine.view(), kJump_mm, coarse.view()), Status::kOk);
      for (int y = 0; y < coarse.height(); ++y) {
        for (int x = 0; x < coarse.width(); ++x) {
          std::vector<float> valid;
          for (int r = 2 * y; r < std::min(h, 2 * y + 2); ++r) {
            for (int c = 2 * x; c < std::min(w, 2 * x + 2); ++c) {
              if (!std::isnan(fine(c, r))) valid.push_back(fine(c, r));
            }
          }
          if (valid.empty()) {
            EXPECT_TRUE(std::isnan(coarse(x, y)));
            continue;
          }
          const float top = *std::max_element(valid.begin(), valid.end());
          double sum = 0.0;
          int count = 0;
          for (const float z : valid) {
            if (z < top - kJump_mm) continue;
            sum += static_cast<double>(z);
            ++count;
          }
          EXPECT_NEAR(coarse(x, y), sum / count, 1e-5);
        }
      }
    }
  }
}

TEST(Halve, KeepsAPlaneAPlaneOnTheHalvedGrid) {
  const rectify::Grid grid{-20.0, 7.0, 0.5, 40, 30};
  const rectify::Grid coarse_grid = halved(grid);
  const auto plane = [](double x_mm, double y_mm) { return 0.3 * x_mm - 0.2 * y_mm + 4.0; };
  const auto fine =
      Image<float>::of(40, 30, [&](int x, int y) { return plane(grid.x_of(x), grid.y_of(y)); });
  Image<float> coarse(coarse_grid.width_px, coarse_grid.height_px);
  ASSERT_EQ(halve(fine.view(), 1.0F, coarse.view()), Status::kOk);
  for (int y = 0; y < coarse.height(); ++y) {
    for (int x = 0; x < coarse.width(); ++x) {
      EXPECT_NEAR(coarse(x, y), plane(coarse_grid.x_of(x), coarse_grid.y_of(y)), 1e-5);
    }
  }
}

TEST(Halve, RefusesBadInput) {
  Image<float> fine(5, 5);
  Image<float> coarse(2, 3);
  EXPECT_EQ(halve(fine.view(), 1.0F, coarse.view()), Status::kShapeMismatch);
  EXPECT_EQ(halve(fine.view(), -1.0F, Image<float>(3, 3).view()), Status::kInvalidArgument);
  EXPECT_EQ(halve(fine.view(), NAN, Image<float>(3, 3).view()), Status::kInvalidArgument);
}

}  // namespace
}  // namespace flatpose::image
