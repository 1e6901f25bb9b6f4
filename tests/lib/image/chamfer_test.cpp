#include "flatpose/image/chamfer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "tests/lib/image/image.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::image {
namespace {

int brute_force(const Image<std::uint8_t>& mask, int x, int y, int max) {
  int nearest = max;
  for (int r = 0; r < mask.height(); ++r) {
    for (int c = 0; c < mask.width(); ++c) {
      if (mask(c, r) == 0) continue;
      const int dx = std::abs(c - x);
      const int dy = std::abs(r - y);
      nearest = std::min(nearest, 3 * std::max(dx, dy) + std::min(dx, dy));
    }
  }
  return nearest;
}

template <class T>
void expect_brute_force(const Image<std::uint8_t>& mask) {
  Image<T> distance(mask.width(), mask.height(), T{7});
  ASSERT_EQ(chamfer_distance(mask.view(), distance.view()), Status::kOk);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      ASSERT_EQ(distance(x, y), brute_force(mask, x, y, std::numeric_limits<T>::max()));
    }
  }
}

TEST(ChamferDistance, EqualsBruteForceOnAllMasksUpTo4x4) {
  for (int h = 1; h <= 4; ++h) {
    for (int w = 1; w <= 4; ++w) {
      for (unsigned bits = 0; bits < 1U << (w * h); ++bits) {
        const auto mask = Image<std::uint8_t>::of(
            w, h, [&](int x, int y) { return (bits >> (y * w + x) & 1U) != 0 ? 255 : 0; });
        expect_brute_force<std::uint16_t>(mask);
        expect_brute_force<std::uint8_t>(mask);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(ChamferDistance, EqualsBruteForceOnWideSparseMasksBeyondSaturation) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Image<float> noise = random_image(197, 23, seed);
    const auto mask = Image<std::uint8_t>::of(197, 23, [&](int x, int y) {
      return noise(x, y) > 9.99F - 0.01F * static_cast<float>(seed) ? 1 : 0;
    });
    expect_brute_force<std::uint16_t>(mask);
    expect_brute_force<std::uint8_t>(mask);
  }
  Image<std::uint8_t> far(23000, 1);
  far(0, 0) = 1;
  Image<std::uint16_t> distance(23000, 1);
  ASSERT_EQ(chamfer_distance(far.view(), distance.view()), Status::kOk);
  EXPECT_EQ(distance(21844, 0), 65532);
  EXPECT_EQ(distance(22999, 0), 65535);
}

TEST(ChamferDistance, IsTheSameOnEveryPathAtEveryWidth) {
  for (int w = 1; w < 200; ++w) {
    const Image<float> noise = random_image(w, 9, static_cast<unsigned>(w));
    const auto mask = Image<std::uint8_t>::of(w, 9, [&](int x, int y) {
      return noise(x, y) > 9.8F - 0.02F * static_cast<float>(w) ? 1 : 0;
    });
    Image<std::uint16_t> wide(w, 9);
    ASSERT_EQ(chamfer_distance(mask.view(), wide.view()), Status::kOk);
    for (const VectorPath path : vector_paths()) {
      Image<std::uint8_t> distance(w, 9, 7);
      ASSERT_EQ(chamfer_distance(mask.view(), distance.view(), path), Status::kOk);
      for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < w; ++x)
          ASSERT_EQ(distance(x, y), std::min<int>(wide(x, y), 255)) << w << ' ' << x << ' ' << y;
      }
    }
  }
}

// OpenCV's 3x3 transform has the same paths with steps of 0.955 and 1.3693, so ours lies between
// fixed multiples of it.
TEST(ChamferDistance, AgreesWithOpenCvWithinTheRatioOfTheSteps) {
  Image<float> noise = random_image(120, 90, 5);
  auto mask =
      Image<std::uint8_t>::of(120, 90, [&](int x, int y) { return noise(x, y) > 9.95F ? 1 : 0; });
  auto inverse =
      Image<std::uint8_t>::of(120, 90, [&](int x, int y) { return mask(x, y) != 0 ? 0 : 1; });
  Image<std::uint16_t> distance(120, 90);
  ASSERT_EQ(chamfer_distance(mask.view(), distance.view()), Status::kOk);
  cv::Mat judge;
  cv::distanceTransform(cv::Mat(90, 120, CV_8U, inverse.data()), judge, cv::DIST_L2, 3);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const double ours_px = distance(x, y) / 3.0;
      const double theirs_px = judge.at<float>(y, x);
      ASSERT_LE(ours_px, theirs_px / 0.955 + 1e-3);
      ASSERT_GE(ours_px, theirs_px * (4.0 / 3.0) / 1.3693 - 1e-3);
    }
  }
}

TEST(ChamferDistance, RefusesDifferentShapes) {
  Image<std::uint8_t> mask(4, 3);
  Image<std::uint16_t> distance(3, 4);
  EXPECT_EQ(chamfer_distance(mask.view(), distance.view()), Status::kShapeMismatch);
}

}  // namespace
}  // namespace flatpose::image
