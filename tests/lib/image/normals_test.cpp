#include "flatpose/image/normals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

TEST(NormalMap, IsRightOnEveryTiltedPlaneUpToTheBorder) {
  for (const double cell_mm : {0.2, 1.0, 3.0}) {
    for (int w = 2; w <= 8; w += 2) {
      for (double a = -1.5; a <= 1.5; a += 0.5) {
        for (double b = -1.5; b <= 1.5; b += 0.5) {
          const auto z = Image<float>::of(
              w, 6, [&](int x, int y) { return 5.0 + a * x * cell_mm + b * y * cell_mm; });
          Image<float> nx(w, 6);
          Image<float> ny(w, 6);
          ASSERT_EQ(normal_map(z.view(), cell_mm, nx.view(), ny.view()), Status::kOk);
          const double length = std::sqrt(1.0 + a * a + b * b);
          for (int y = 0; y < 6; ++y) {
            for (int x = 0; x < w; ++x) {
              ASSERT_NEAR(nx(x, y), -a / length, 1e-5);
              ASSERT_NEAR(ny(x, y), -b / length, 1e-5);
              ASSERT_NEAR(normal_z(nx(x, y), ny(x, y)), 1.0 / length, 1e-5);
            }
          }
        }
      }
    }
  }
}

TEST(NormalMap, IsMissingAroundMissingCells) {
  Image<float> z(7, 7, 1.0F);
  z(0, 0) = kMissing;
  z(4, 4) = kMissing;
  Image<float> nx(7, 7);
  Image<float> ny(7, 7);
  ASSERT_EQ(normal_map(z.view(), 1.0, nx.view(), ny.view()), Status::kOk);
  for (int y = 3; y <= 5; ++y) {
    for (int x = 3; x <= 5; ++x) EXPECT_TRUE(std::isnan(nx(x, y)) && std::isnan(ny(x, y)));
  }
  EXPECT_TRUE(std::isnan(nx(0, 0)));
  EXPECT_TRUE(std::isnan(normal_z(nx(0, 0), ny(0, 0))));
  EXPECT_EQ(nx(6, 0), 0.0F);
}

TEST(NormalMap, TakesTheSmallestImagesAndRefusesBadInput) {
  Image<float> one(1, 1, 3.0F);
  Image<float> nx(1, 1);
  Image<float> ny(1, 1);
  ASSERT_EQ(normal_map(one.view(), 1.0, nx.view(), ny.view()), Status::kOk);
  EXPECT_EQ(nx(0, 0), 0.0F);
  EXPECT_EQ(normal_map(one.view(), 0.0, nx.view(), ny.view()), Status::kInvalidArgument);
  EXPECT_EQ(normal_map(one.view(), NAN, nx.view(), ny.view()), Status::kInvalidArgument);
  Image<float> two(2, 1);
  EXPECT_EQ(normal_map(one.view(), 1.0, two.view(), ny.view()), Status::kShapeMismatch);
}

}  // namespace
}  // namespace flatpose::image
