#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/autodiff/dual.hpp"
#include "flatpose/image/bilinear.hpp"
#include "flatpose/image/bspline.hpp"
#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

using autodiff::Dual;

TEST(Bspline, SmoothsThePixelsByOneFourOneOverSixAtEverySize) {
  constexpr std::array kWeight = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  for (int h = 1; h <= 8; ++h) {
    for (int w = 1; w <= 8; ++w) {
      const Image<float> pixels = random_image(w, h, static_cast<unsigned>(w * 100 + h));
      // Mirrored about the border cells' centres.
      const auto pixel = [&](int x, int y) {
        const int column = x < 0 ? std::min(1, w - 1) : x < w ? x : std::max(0, w - 2);
        const int row = y < 0 ? std::min(1, h - 1) : y < h ? y : std::max(0, h - 2);
        return static_cast<double>(pixels(column, row));
      };
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          double mean = 0.0;
          for (int j = -1; j <= 1; ++j) {
            for (int i = -1; i <= 1; ++i)
              mean += kWeight[i + 1] * kWeight[j + 1] * pixel(x + i, y + j);
          }
          const double value = bspline(pixels.view(), 1.0 * x, 1.0 * y);
          ASSERT_NEAR(value, mean, 1e-6) << w << "x" << h << " at " << x << "," << y;
        }
      }
    }
  }
}

TEST(Bspline, ReadsAnyImageOfBytes) {
  struct Slope {
    int width_px = 9;
    int height_px = 7;
    std::uint8_t operator()(int x, int y) const { return static_cast<std::uint8_t>(20 * x + y); }
  };
  const Sample s = bspline_sample(Slope{}, 4.3, 3.6);
  EXPECT_NEAR(s.value, 20 * 4.3 + 3.6, 1e-9);
  EXPECT_NEAR(s.slope_x, 20.0, 1e-9);
  EXPECT_NEAR(s.slope_y, 1.0, 1e-9);
}

TEST(Bspline, IsTwiceContinuouslyDifferentiableAcrossTheKnots) {
  const Image<float> c = random_image(16, 16, 4);
  const ImageView<const float> view = c.view();
  constexpr double kStep = 1e-3;
  for (double y = 1.3; y < 14.0; y += 1.7) {
    for (int knot = 2; knot <= 13; ++knot) {
      const auto slope = [&](double x) { return bspline_sample(view, x, y).slope_x; };
      const double left = (slope(knot) - slope(knot - kStep)) / kStep;
      const double right = (slope(knot + kStep) - slope(knot)) / kStep;
      // A jump of the second derivative would be some 10; what is left is the third times the step.
      EXPECT_NEAR(left, right, 0.5);
      EXPECT_NEAR(bspline_sample(view, knot - 1e-9, y).value, bspline_sample(view, knot, y).value,
                  1e-6);
    }
  }
}

// Smoothing lifts x^2 by a third everywhere; slopes are met exactly.
TEST(Bspline, LiftsAParabolaBySixthsOfItsSecondDerivatives) {
  const auto parabola = [](double x, double y) { return 0.01 * x * x - 0.02 * x * y + 0.3 * y; };
  const Image<float> c = Image<float>::of(60, 60, parabola);
  for (double x = 1.0; x < 58.0; x += 0.37) {
    const Sample s = bspline_sample(c.view(), x, 31.7);
    EXPECT_NEAR(s.value, parabola(x, 31.7) + 0.02 / 6.0, 1e-5);
    EXPECT_NEAR(s.slope_x, 0.02 * x - 0.02 * 31.7, 1e-5);
    EXPECT_NEAR(s.slope_y, -0.02 * x + 0.3, 1e-5);
  }
}

template <class SampleAt>
void expect_slopes_of(const SampleAt& sample_at) {
  constexpr double kStep = 1e-6;
  for (double y = 0.13; y < 10.9; y += 0.61) {
    for (double x = 0.17; x < 12.9; x += 0.5731) {
      const Sample s = sample_at(x, y);
      EXPECT_NEAR(s.slope_x,
                  (sample_at(x + kStep, y).value - sample_at(x - kStep, y).value) / (2.0 * kStep),
                  1e-5);
      EXPECT_NEAR(s.slope_y,
                  (sample_at(x, y + kStep).value - sample_at(x, y - kStep).value) / (2.0 * kStep),
                  1e-5);
    }
  }
}

TEST(Interpolation, SlopesAreThoseOfFiniteDifferences) {
  const Image<float> image = random_image(14, 12, 6);
  expect_slopes_of([&](double x, double y) { return bilinear_sample(image.view(), x, y); });
  expect_slopes_of([&](double x, double y) { return bspline_sample(image.view(), x, y); });
}

TEST(Interpolation, ClampsOutsideWithNoSlopeAcross) {
  Image<float> image = random_image(6, 5, 7);
  const auto view = std::as_const(image).view();
  for (const double outside : {-0.1, -1e30, 5.1, 1e30, static_cast<double>(NAN)}) {
    const double border = outside > 0.0 ? 5.0 : 0.0;
    EXPECT_EQ(bilinear_sample(view, outside, 1.5).value, bilinear_sample(view, border, 1.5).value);
    EXPECT_EQ(bilinear_sample(view, outside, 1.5).slope_x, 0.0);
    EXPECT_EQ(bspline_sample(view, outside, 1.5).value, bspline_sample(view, border, 1.5).value);
    EXPECT_EQ(bspline_sample(view, outside, 1.5).slope_x, 0.0);
    EXPECT_NE(bspline_sample(view, outside, 1.5).slope_y, 0.0);
    EXPECT_EQ(bilinear(view, 2.0, outside), bilinear(view, 2.0, outside > 0.0 ? 4.0 : 0.0));
  }
}

TEST(Bilinear, IsTheMeanOfItsFourPixelsInTheMiddleAndExactAtTheCentres) {
  for (int h = 1; h <= 3; ++h) {
    for (int w = 1; w <= 3; ++w) {
      const Image<float> image = random_image(w, h, 8);
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          EXPECT_NEAR(bilinear(image.view(), double(x), double(y)), image(x, y), 1e-6);
        }
      }
    }
  }
  const Image<float> image = random_image(2, 2, 9);
  const double mean = (double(image(0, 0)) + image(1, 0) + image(0, 1) + image(1, 1)) / 4.0;
  EXPECT_NEAR(bilinear(image.view(), 0.5, 0.5), mean, 1e-6);
}

TEST(Interpolation, CarriesTheDerivativesOfDualNumbers) {
  const Image<float> image = random_image(14, 12, 10);
  using D = Dual<2>;
  const D t(0.4, {1.0, 0.0});
  const D u(0.7, {0.0, 1.0});
  const D x = D(3.0) + t * u * D(5.0);
  const D y = D(2.0) + t * t + u;
  const auto check = [&](const D& value, const Sample& s) {
    EXPECT_NEAR(value.value, s.value, 1e-12);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(value.derivative[i], s.slope_x * x.derivative[i] + s.slope_y * y.derivative[i],
                  1e-12);
    }
  };
  check(bilinear(image.view(), x, y), bilinear_sample(image.view(), x.value, y.value));
  check(bspline(image.view(), x, y), bspline_sample(image.view(), x.value, y.value));
}

}  // namespace
}  // namespace flatpose::image
