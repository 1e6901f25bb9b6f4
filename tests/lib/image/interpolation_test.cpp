#include <gtest/gtest.h>

#include <cmath>

#include "flatpose/autodiff/dual.hpp"
#include "flatpose/image/bilinear.hpp"
#include "flatpose/image/bspline.hpp"
#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

using autodiff::Dual;

TEST(Bspline, PassesThroughThePixelsAtEverySize) {
  for (int h = 1; h <= 40; h += h < 20 ? 1 : 7) {
    for (int w = 1; w <= 40; w += w < 20 ? 1 : 7) {
      const Image<float> pixels = random_image(w, h, static_cast<unsigned>(w * 100 + h));
      Image<float> c = pixels;
      bspline_prefilter(c.view());
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          const double value =
              bspline(std::as_const(c).view(), static_cast<double>(x), static_cast<double>(y));
          ASSERT_NEAR(value, pixels(x, y), 2e-5) << w << "x" << h << " at " << x << "," << y;
        }
      }
    }
  }
}

TEST(Bspline, FiltersAPartOfAnImageAsIfAlone) {
  const Image<float> whole = random_image(20, 20, 3);
  Image<float> part = Image<float>::of(9, 8, [&](int x, int y) { return whole(x + 4, y + 5); });
  Image<float> filtered = whole;
  bspline_prefilter(part.view());
  bspline_prefilter(ImageView<float>{filtered.view().row(5) + 4, 9, 8, 20});
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool inside = x >= 4 && x < 13 && y >= 5 && y < 13;
      ASSERT_EQ(filtered(x, y), inside ? part(x - 4, y - 5) : whole(x, y));
    }
  }
}

TEST(Bspline, IsTwiceContinuouslyDifferentiableAcrossTheKnots) {
  Image<float> c = random_image(16, 16, 4);
  bspline_prefilter(c.view());
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

// A parabola is a cubic spline, so away from the mirrored border it is met exactly.
TEST(Bspline, ReproducesAParabola) {
  const auto parabola = [](double x, double y) { return 0.01 * x * x - 0.02 * x * y + 0.3 * y; };
  Image<float> c = Image<float>::of(60, 60, parabola);
  bspline_prefilter(c.view());
  for (double x = 20.0; x < 40.0; x += 0.37) {
    const Sample s = bspline_sample(c.view(), x, 31.7);
    EXPECT_NEAR(s.value, parabola(x, 31.7), 1e-4);
    EXPECT_NEAR(s.slope_x, 0.02 * x - 0.02 * 31.7, 1e-4);
    EXPECT_NEAR(s.slope_y, -0.02 * x + 0.3, 1e-4);
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
