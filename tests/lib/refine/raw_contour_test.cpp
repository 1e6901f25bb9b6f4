// Where a surface ends, on scans whose edge is known to any fraction of a point.

#include "flatpose/refine/raw_contour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/lib/locate/made_scan.hpp"

namespace flatpose::refine {
namespace {

using test::MadeScan;
using test::MadeScene;

constexpr int kSize_px = 61;
constexpr double kMiddle_mm = 30.0;
constexpr double kTop_mm = 10.0;

/// A surface that ends on a straight line, its normal at an angle, a distance from the middle.
struct StraightEdge {
  double angle_rad = 0.0;
  double place_mm = 0.0;
  double beyond_mm = 0.0;  ///< Height of what follows.
  double ramp_mm = 0.0;    ///< Over which the height falls, from the edge on.

  [[nodiscard]] double across(double x, double y) const {
    return (x - kMiddle_mm) * std::cos(angle_rad) + (y - kMiddle_mm) * std::sin(angle_rad) -
           place_mm;
  }
  [[nodiscard]] MadeScan scan(double pitch_mm = 1.0) const {
    const int size_px = static_cast<int>((kSize_px - 1) / pitch_mm) + 1;
    return {size_px, size_px, pitch_mm, [this](double x, double y) {
              const double u = across(x, y);
              if (u < 0.0) return kTop_mm;
              return u < ramp_mm ? kTop_mm + (beyond_mm - kTop_mm) * u / ramp_mm : beyond_mm;
            }};
  }
};

/// The contour as it is expected: through the middle of the scan, `along_mm` from it.
model::ContourPoint expected_point(double angle_rad, double along_mm = 0.0) {
  const double nx = std::cos(angle_rad);
  const double ny = std::sin(angle_rad);
  model::ContourPoint p =
      test::contour_point(kMiddle_mm - along_mm * ny, kMiddle_mm + along_mm * nx, nx, ny, kTop_mm);
  p.z_mm = static_cast<float>(kTop_mm);
  return p;
}

Crossing measured(const MadeScan& scan, const model::ContourPoint& point, double search_mm = 4.0) {
  const MadeScene made(scan);
  const RawScan raw{scan.view(), {}, &made.scene.map};
  return measure_crossing(raw, {}, point, {search_mm, 0.5});
}

constexpr double kFourWays_rad[] = {0.0, 0.5 * kPi, kPi, 1.5 * kPi};

TEST(RawContour, IsUnbiasedAtAnyFractionOfAPitchInAllFourScanDirections) {
  constexpr int kPlaceCount = 20;
  for (const double angle_rad : kFourWays_rad) {
    for (const double pitch_mm : {1.0, 0.5}) {
      double sum_mm = 0.0;
      for (int k = 0; k < kPlaceCount; ++k) {
        const double place_mm = pitch_mm * (-1.0 + 2.0 * (k + 0.5) / kPlaceCount);
        const MadeScan scan = StraightEdge{angle_rad, place_mm}.scan(pitch_mm);
        const Crossing crossing = measured(scan, expected_point(angle_rad));
        ASSERT_TRUE(crossing.found) << angle_rad << " " << place_mm;
        const double error_mm = crossing.offset_mm - place_mm;
        EXPECT_LE(std::fabs(error_mm), 0.501 * pitch_mm) << angle_rad << " " << place_mm;
        EXPECT_EQ(crossing.width_mm, 0.0);
        sum_mm += error_mm;
      }
      EXPECT_NEAR(sum_mm / kPlaceCount, 0.0, 0.01 * pitch_mm) << angle_rad;
    }
  }
}

TEST(RawContour, IsUnbiasedOnObliqueEdges) {
  constexpr double kPlace_mm = 0.37;
  for (int degrees = 5; degrees < 360; degrees += 11) {
    const double angle_rad = degrees * kRadPerDeg;
    const MadeScan scan = StraightEdge{angle_rad, kPlace_mm}.scan();
    const MadeScene made(scan);
    const RawScan raw{scan.view(), {}, &made.scene.map};
    double sum_mm = 0.0;
    int count = 0;
    for (double along_mm = -20.0; along_mm <= 20.0; along_mm += 0.41, ++count) {
      const Crossing crossing =
          measure_crossing(raw, {}, expected_point(angle_rad, along_mm), {3.0, 0.5});
      ASSERT_TRUE(crossing.found) << degrees << " at " << along_mm;
      EXPECT_LE(std::fabs(crossing.offset_mm - kPlace_mm), 0.51);
      sum_mm += crossing.offset_mm - kPlace_mm;
    }
    // The error of a single line runs through all of its range where the edge crosses many lines;
    // what remains of the mean is the last one, cut off.
    const double lines_crossed =
        40.0 * std::min(std::fabs(std::sin(angle_rad)), std::fabs(std::cos(angle_rad)));
    EXPECT_NEAR(sum_mm / count, 0.0, 0.02 + 0.5 / std::max(1.0, lines_crossed)) << degrees;
  }
}

TEST(RawContour, IsMeasuredAlikeWhereverThePartLies) {
  const double angle_rad = 0.3;
  const MadeScan scan = StraightEdge{angle_rad, 0.2}.scan();
  const MadeScene made(scan);
  const RawScan raw{scan.view(), {}, &made.scene.map};
  const Crossing plain = measure_crossing(raw, {}, expected_point(angle_rad), {3.0, 0.5});
  // The same contour point in an object frame that is turned and shifted against the scan.
  const Pose work_T_object = test::pose_at(12.0, -7.0, 3.0, 1.1);
  const model::ContourPoint p = expected_point(angle_rad);
  const Vec3 at = work_T_object.inverse() * Vec3{p.x_mm, p.y_mm, p.z_mm};
  const Vec3 n = work_T_object.rotation.inverse() * Vec3{p.nx, p.ny, 0.0};
  model::ContourPoint turned = test::contour_point(at.x, at.y, n.x, n.y, p.step_mm);
  turned.z_mm = static_cast<float>(at.z);
  const Crossing other = measure_crossing(raw, work_T_object, turned, {3.0, 0.5});
  ASSERT_TRUE(plain.found);
  ASSERT_TRUE(other.found);
  EXPECT_NEAR(plain.offset_mm, other.offset_mm, 1e-4);
}

TEST(RawContour, IsNotFoundWhereSomethingHigherHidesIt) {
  for (const double angle_rad : kFourWays_rad) {
    const MadeScan scan = StraightEdge{angle_rad, 0.2, 25.0}.scan();
    EXPECT_FALSE(measured(scan, expected_point(angle_rad)).found) << angle_rad;
  }
}

TEST(RawContour, AnEdgeThatOvershootsIsFoundAndOneUnderABarIsNot) {
  constexpr double kPitch_mm = 0.25;
  for (const double angle_rad : kFourWays_rad) {
    for (const double above_mm : {0.7, 2.6}) {
      const StraightEdge edge{angle_rad, 0.2};
      const MadeScan scan(241, 241, kPitch_mm, [&](double x, double y) {
        const double u = edge.across(x, y);
        if (u < 0.0) return kTop_mm;
        return u < above_mm ? kTop_mm + 4.0 : 0.0;
      });
      const Crossing crossing = measured(scan, expected_point(angle_rad));
      EXPECT_EQ(crossing.found, above_mm < 1.0) << angle_rad << " " << above_mm;
    }
  }
}

TEST(RawContour, IsFoundWhereAShadowFollows) {
  for (const double angle_rad : kFourWays_rad) {
    const MadeScan scan = StraightEdge{angle_rad, 0.2, test::kLost}.scan();
    const Crossing crossing = measured(scan, expected_point(angle_rad));
    ASSERT_TRUE(crossing.found) << angle_rad;
    EXPECT_NEAR(crossing.offset_mm, 0.2, 0.501);
  }
}

TEST(RawContour, SinglePointsEndNoSurface) {
  // The surface ends at column 33.5; the walk starts two cells inside of the middle.
  for (const double z_mm : {test::kLost, 0.0, 40.0}) {
    MadeScan scan = StraightEdge{0.0, 3.5}.scan();
    for (const int column : {29, 31}) {
      for (int row = 0; row < kSize_px; ++row) {
        float* const p = scan.at(column, row);
        if (std::isnan(z_mm)) p[0] = p[1] = static_cast<float>(z_mm);
        p[2] = static_cast<float>(z_mm);
      }
    }
    const Crossing crossing = measured(scan, expected_point(0.0));
    ASSERT_TRUE(crossing.found) << z_mm;
    EXPECT_NEAR(crossing.offset_mm, 3.5, 0.501) << z_mm;
  }
}

TEST(RawContour, EndOfTheFieldIsNoContour) {
  const double border_mm = kSize_px - 1;
  const MadeScan scan = StraightEdge{0.0, 1000.0}.scan();
  for (const double angle_rad : kFourWays_rad) {
    model::ContourPoint p = expected_point(angle_rad);
    p.x_mm += static_cast<float>(0.5 * border_mm * p.nx);
    p.y_mm += static_cast<float>(0.5 * border_mm * p.ny);
    EXPECT_FALSE(measured(scan, p).found) << angle_rad;
  }
}

TEST(RawContour, IsNotFoundBeyondTheSearch) {
  for (const double angle_rad : kFourWays_rad) {
    for (const double place_mm : {-8.0, 5.0}) {
      const MadeScan scan = StraightEdge{angle_rad, place_mm}.scan();
      EXPECT_FALSE(measured(scan, expected_point(angle_rad), 2.0).found) << place_mm;
    }
  }
}

TEST(RawContour, IsNotFoundWhereTheSurfaceIsNot) {
  const MadeScan floor(kSize_px, kSize_px, 1.0, [](double, double) { return 0.0; });
  EXPECT_FALSE(measured(floor, expected_point(0.0)).found);
  const MadeScan nothing(kSize_px, kSize_px, 1.0, [](double x, double) {
    return x < 1.5 ? 0.0 : test::kLost;  // a scene must hold something
  });
  EXPECT_FALSE(measured(nothing, expected_point(0.0)).found);
}

TEST(RawContour, ReportsTheWidthOfARamp) {
  for (const double angle_rad : kFourWays_rad) {
    double last_mm = 0.0;
    for (const double ramp_mm : {2.4, 4.4, 6.4, 8.4}) {
      const MadeScan scan = StraightEdge{angle_rad, -0.2, 0.0, ramp_mm}.scan();
      const Crossing crossing = measured(scan, expected_point(angle_rad), 8.0);
      ASSERT_TRUE(crossing.found) << ramp_mm;
      EXPECT_NEAR(crossing.width_mm, ramp_mm, 1.01) << ramp_mm;
      EXPECT_GT(crossing.width_mm, last_mm);
      // It ends somewhere on the ramp.
      EXPECT_GE(crossing.offset_mm, -0.7);
      EXPECT_LE(crossing.offset_mm, ramp_mm + 0.3);
      last_mm = crossing.width_mm;
    }
  }
}

}  // namespace
}  // namespace flatpose::refine
