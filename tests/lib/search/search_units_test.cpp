// Heights and normals as the search's images hold them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/geometry/vec3.hpp"
#include "tests/lib/search/made_scene_images.hpp"

namespace flatpose::search {
namespace {

TEST(SearchUnits, HeightsAreRoundedToTheNearestUnitAboveTheBase) {
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    MadeScene made(image::random_image(41, 30, 3));
    ASSERT_EQ(made.build({.stride_px = stride_px}), Status::kOk);
    for (int y = 0; y < made.height_px(); ++y) {
      for (int x = 0; x < made.width(); ++x) {
        const double above_mm = made.images.filled_mm(x, y) - made.images.base_mm;
        const double unit = std::clamp(above_mm / made.images.height_unit_mm, 0.0, 240.0);
        ASSERT_NEAR(made.images.height_unit(x, y), unit, 0.5 + 1e-9);
      }
    }
  }
}

TEST(SearchUnits, HeightsBeyondTheRangeSaturateOnTheirOwnSide) {
  MadeScene made(image::Image<float>::of(8, 8, [](int x, int) { return x < 4 ? -9e6F : 9e6F; }));
  ASSERT_EQ(made.build(), Status::kOk);
  EXPECT_EQ(made.images.height_unit(0, 0), 0);
  EXPECT_EQ(made.images.height_unit(3, 3), kHeightUnitMax) << "what is outside is higher";
}

/// Builds images of level ground and judges the trade between tolerance and range.
void check_units(double low_mm, double high_mm, double tolerance_mm) {
  SCOPED_TRACE(testing::Message() << low_mm << ".." << high_mm << " by " << tolerance_mm);
  MadeScene made(image::Image<float>(4, 4));
  ASSERT_EQ(made.build({.height_tolerance_mm = tolerance_mm}, {low_mm, high_mm}), Status::kOk);
  const SearchImages& images = made.images;
  const double unit_mm = images.height_unit_mm;
  // A tenth of the tolerance, unless the range then is more than a byte.
  EXPECT_GE(unit_mm, tolerance_mm / 10.0 * (1 - 1e-12));
  if (high_mm - low_mm + 4.0 * tolerance_mm <= 240.0 * tolerance_mm / 10.0) {
    EXPECT_DOUBLE_EQ(unit_mm, tolerance_mm / 10.0);
  }
  // All of the range is told apart, and the tolerance beyond it unless that is less than a unit.
  if (unit_mm <= tolerance_mm) {
    EXPECT_GE(height_unit(low_mm - tolerance_mm, images), 1);
    EXPECT_LT(height_unit(high_mm + tolerance_mm, images), kHeightUnitMax);
  }
  EXPECT_NEAR(height_unit(high_mm, images) - height_unit(low_mm, images),
              (high_mm - low_mm) / unit_mm, 1.0 + 1e-6);
  // The cap is the tolerance while the units are fine enough for it; the weight makes up for it.
  EXPECT_GE(images.surface_cap, 2);
  EXPECT_LE(images.surface_cap, kSurfaceCostMax);
  if (unit_mm < tolerance_mm / 2.0) {
    EXPECT_NEAR(images.surface_cap, tolerance_mm / unit_mm, 0.501);
  }
  EXPECT_LE(images.surface_cap * images.surface_weight, kSurfaceCostMax);
  EXPECT_GT(images.surface_cap * (images.surface_weight + 1), kSurfaceCostMax);
}

TEST(SearchUnits, FitTheRangeIntoAByteAndTheToleranceIntoTheRange) {
  for (const double tolerance_mm : {0.01, 0.3, 3.0, 40.0}) {
    for (const double low_mm : {-800.0, 0.0, 1234.5}) {
      for (const double span_mm : {0.0, 0.1, 1.0, 5.9, 6.1, 20.0, 60.0, 300.0, 5000.0})
        check_units(low_mm, low_mm + span_mm, tolerance_mm);
    }
  }
}

TEST(SearchUnits, GrowCoarserWithTheRangeDownToTwoStepsOfTheTolerance) {
  MadeScene made(image::Image<float>(4, 4));
  int previous_cap = kSurfaceCostMax;
  for (double span_mm = 10.0; span_mm < 1e5; span_mm *= 1.5) {
    ASSERT_EQ(made.build({}, {0.0, span_mm}), Status::kOk);
    EXPECT_LE(made.images.surface_cap, previous_cap);
    previous_cap = made.images.surface_cap;
  }
  EXPECT_EQ(previous_cap, 2);
}

TEST(SearchUnits, OfNormalsKeepTheFullCap) {
  MadeScene made(image::Image<float>(4, 4));
  ASSERT_EQ(made.build({.use_height = false}, {0.0, 1e5}), Status::kOk);
  EXPECT_EQ(made.images.surface_cap, kSurfaceCostMax);
  EXPECT_EQ(made.images.surface_weight, 1);
}

TEST(SearchUnits, NormalsArePlanesNormals) {
  for (const auto& [sx, sy] : {std::pair{0.0, 0.0}, {0.5, -0.25}, {-3.0, 2.0}, {40.0, -60.0}}) {
    for (const double tolerance_rad : {0.05, 0.1, 0.35, 3.0}) {
      MadeScene made(image::Image<float>::of(
          16, 12, [&, a = sx, b = sy](int x, int y) { return 0.5 * (a * x + b * y); }));
      ASSERT_EQ(made.build({.normal_tolerance_rad = tolerance_rad, .use_height = false}),
                Status::kOk);
      const Vec3 normal = normalized({-sx, -sy, 1.0});
      const auto unit = [&, t = tolerance_rad](double component) {
        return std::clamp(127.0 + component / (t / 10.0), 0.0, 254.0);
      };
      for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 8; ++x) {
          ASSERT_NEAR(made.images.normal_x_unit(x, y), unit(normal.x), 0.51);
          ASSERT_NEAR(made.images.normal_y_unit(x, y), unit(normal.y), 0.51);
        }
      }
    }
  }
}

TEST(SearchUnits, NoNormalLooksLikeOutside) {
  for (const double tolerance_rad : {1e-9, 0.01, 0.35}) {
    const SearchImagesConfig config{.normal_tolerance_rad = tolerance_rad};
    EXPECT_EQ(normal_unit(0.0, config), kNormalZero);
    for (const double component : {-1.0, -0.4, 0.4, 1.0}) {
      EXPECT_GE(normal_unit(component, config), 0);
      EXPECT_LT(normal_unit(component, config), kOutsideUnit);
      EXPECT_EQ(normal_unit(component, config) > kNormalZero, component > 0.0);
    }
  }
}

}  // namespace
}  // namespace flatpose::search
