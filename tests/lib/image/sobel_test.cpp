#include "flatpose/image/sobel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

TEST(Sobel, EqualsOpenCvWithRepeatedBorderAtEverySize) {
  for (int h = 1; h <= 9; ++h) {
    for (int w = 1; w <= 21; ++w) {
      Image<float> z = random_image(w, h, 1);
      Image<float> x(w, h);
      Image<float> y(w, h);
      ASSERT_EQ(sobel(z.view(), x.view(), y.view()), Status::kOk);
      const cv::Mat source(h, w, CV_32F, z.data());
      cv::Mat judge_x;
      cv::Mat judge_y;
      cv::Sobel(source, judge_x, CV_32F, 1, 0, 3, 0.125, 0.0, cv::BORDER_REPLICATE);
      cv::Sobel(source, judge_y, CV_32F, 0, 1, 3, 0.125, 0.0, cv::BORDER_REPLICATE);
      for (int r = 0; r < h; ++r) {
        for (int c = 0; c < w; ++c) {
          ASSERT_NEAR(x(c, r), judge_x.at<float>(r, c), 1e-5) << w << "x" << h;
          ASSERT_NEAR(y(c, r), judge_y.at<float>(r, c), 1e-5) << w << "x" << h;
        }
      }
    }
  }
}

TEST(Sobel, IsMissingExactlyWhereOneOfTheNineIs) {
  constexpr int kSize = 12;
  for (int my = 0; my < kSize; ++my) {
    for (int mx = 0; mx < kSize; ++mx) {
      Image<float> z = random_image(kSize, kSize, 2);
      z(mx, my) = kMissing;
      Image<float> x(kSize, kSize);
      Image<float> y(kSize, kSize);
      ASSERT_EQ(sobel(z.view(), x.view(), y.view()), Status::kOk);
      for (int r = 0; r < kSize; ++r) {
        for (int c = 0; c < kSize; ++c) {
          const bool near = std::abs(c - mx) <= 1 && std::abs(r - my) <= 1;
          ASSERT_EQ(std::isnan(x(c, r)), near);
          ASSERT_EQ(std::isnan(y(c, r)), near);
        }
      }
    }
  }
}

TEST(Sobel, RefusesDifferentShapes) {
  Image<float> a(3, 3);
  Image<float> b(3, 4);
  EXPECT_EQ(sobel(a.view(), a.view(), b.view()), Status::kShapeMismatch);
  EXPECT_EQ(sobel(a.view(), b.view(), a.view()), Status::kShapeMismatch);
}

}  // namespace
}  // namespace flatpose::image
