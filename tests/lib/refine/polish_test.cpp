// The last step on raw points, on parts drawn by hand.

#include "flatpose/refine/polish.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "flatpose/refine/pose_problem.hpp"
#include "tests/lib/locate/made_scan.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::refine {
namespace {

using test::MadeScan;
using test::MadeScene;

constexpr double kWidth_mm = 50.0;
constexpr double kHeight_mm = 30.0;
constexpr double kTop_mm = 10.0;

const Pose kTruth = test::pose_at(45.3, 40.8, kTop_mm, 17.0 * kRadPerDeg);

MadeScan rectangle_scan(double pitch_mm, double noise_mm, unsigned seed = 1) {
  return {static_cast<int>(90 / pitch_mm),
          static_cast<int>(80 / pitch_mm),
          pitch_mm,
          [](double x, double y) {
            return test::on_rectangle(kTruth, kWidth_mm, kHeight_mm, x, y) ? kTop_mm : 0.0;
          },
          noise_mm,
          seed};
}

MadeScan disc_scan() {
  return {90, 80, 1.0, [](double x, double y) {
            const double dx = x - kTruth.position_mm.x;
            const double dy = y - kTruth.position_mm.y;
            return dx * dx + dy * dy <= 25.0 * 25.0 ? kTop_mm : 0.0;
          }};
}

model::Template rectangle(double pitch_mm = 1.0) {
  model::Template part = test::rectangle_part(kWidth_mm, kHeight_mm, kTop_mm);
  part.pitch_mm = pitch_mm;
  return part;
}

Pose displaced(const Pose& pose) {
  Vector<6> step;
  step << 0.008, -0.006, 0.015, 0.8, -0.7, 0.3;
  return moved(pose, step);
}

Matrix<6> covariance_of(const PolishResult& result) { return Matrix<6>(result.covariance.data()); }

struct Polished {
  std::vector<std::byte> memory = std::vector<std::byte>(1'000'000);
  Arena arena{std::span(memory)};
  PolishScratch scratch = take_polish_scratch(arena);
  Result<PolishResult> result = Status::kTooFewPoints;
};

Polished polished(const model::Template& part, const MadeScan& scan, const Pose& start) {
  const MadeScene made(scan);
  const RawScan raw{scan.view(), {}, &made.scene.map};
  Polished out;
  out.result = polish(part, raw, start, {}, out.scratch, callers_thread);
  return out;
}

bool is_symmetric_with_positive_diagonal(const Matrix<6>& c) {
  for (int i = 0; i < 6; ++i) {
    if (!(c(i, i) > 0.0)) return false;
    for (int j = 0; j < 6; ++j) {
      if (std::fabs(c(i, j) - c(j, i)) > 1e-9 * std::sqrt(c(i, i) * c(j, j))) return false;
      if (std::fabs(c(i, j)) > 1.0001 * std::sqrt(c(i, i) * c(j, j))) return false;
    }
  }
  return true;
}

TEST(Polish, RecoversADisplacedPose) {
  const auto p = polished(rectangle(), rectangle_scan(1.0, 0.0), displaced(kTruth));
  ASSERT_TRUE(p.result) << to_string(p.result.status());
  const test::PoseError e = test::pose_error(p.result->work_T_object, kTruth);
  EXPECT_LT(e.in_plane_mm, 0.1);
  EXPECT_LT(e.z_mm, 0.001);
  EXPECT_LT(e.tilt_deg, 0.001);
  EXPECT_LT(e.turn_deg, 0.2);
  EXPECT_FALSE(p.result->turn_is_free);
  EXPECT_LT(p.result->surface_rms_mm, 0.001);
  EXPECT_LT(p.result->edge_rms_mm, 0.5);
  EXPECT_GT(p.result->crossing_count, 60);
}

TEST(Polish, EndsAtThePlaceWhereverItStarts) {
  const model::Template part = rectangle();
  const MadeScan scan = rectangle_scan(1.0, 0.1);
  const auto a = polished(part, scan, kTruth);
  const auto b = polished(part, scan, displaced(kTruth));
  ASSERT_TRUE(a.result);
  ASSERT_TRUE(b.result);
  const test::PoseError e = test::pose_error(a.result->work_T_object, b.result->work_T_object);
  EXPECT_LT(e.in_plane_mm, 0.05);
  EXPECT_LT(e.z_mm, 0.01);
  EXPECT_LT(e.tilt_deg, 0.02);
  EXPECT_LT(e.turn_deg, 0.1);
}

TEST(Polish, ErrorsLieWithinTheirStandardDeviations) {
  const model::Template part = rectangle();
  constexpr int kSeedCount = 20;
  double chi2[3] = {};
  for (unsigned seed = 0; seed < kSeedCount; ++seed) {
    const auto p = polished(part, rectangle_scan(1.0, 0.2, seed), displaced(kTruth));
    ASSERT_TRUE(p.result);
    const Matrix<6> c = covariance_of(*p.result);
    EXPECT_TRUE(is_symmetric_with_positive_diagonal(c));
    const Pose d = kTruth.inverse() * p.result->work_T_object;
    chi2[0] += d.position_mm.z * d.position_mm.z / c(5, 5);
    chi2[1] += d.rotation.m[7] * d.rotation.m[7] / c(0, 0);
    chi2[2] += d.rotation.m[2] * d.rotation.m[2] / c(1, 1);
  }
  // Patches may share points, so a standard deviation may be too small by a factor, not by three.
  for (const double sum : chi2) EXPECT_LT(sum / kSeedCount, 9.0);
}

TEST(Polish, CovarianceShrinksWithMorePoints) {
  const auto coarse = polished(rectangle(1.0), rectangle_scan(1.0, 0.1), kTruth);
  const auto fine = polished(rectangle(0.5), rectangle_scan(0.5, 0.1), kTruth);
  ASSERT_TRUE(coarse.result);
  ASSERT_TRUE(fine.result);
  const Matrix<6> coarse_c = covariance_of(*coarse.result);
  const Matrix<6> fine_c = covariance_of(*fine.result);
  EXPECT_TRUE(is_symmetric_with_positive_diagonal(coarse_c));
  EXPECT_TRUE(is_symmetric_with_positive_diagonal(fine_c));
  for (int i = 0; i < 6; ++i) EXPECT_LT(fine_c(i, i), coarse_c(i, i)) << i;
  model::Template half = rectangle(1.0);
  half.contour_count /= 2;
  const auto less = polished(half, rectangle_scan(1.0, 0.1), kTruth);
  ASSERT_TRUE(less.result);
  const Matrix<6> less_c = covariance_of(*less.result);
  for (const int i : {2, 3, 4}) EXPECT_GT(less_c(i, i), 1.2 * coarse_c(i, i)) << i;
}

TEST(Polish, FullSymmetryLeavesTheTurnFree) {
  const Pose start = displaced(kTruth);
  const auto p = polished(test::disc_part(25.0, kTop_mm), disc_scan(), start);
  ASSERT_TRUE(p.result) << to_string(p.result.status());
  EXPECT_TRUE(p.result->turn_is_free);
  const test::PoseError e = test::pose_error(p.result->work_T_object, kTruth);
  EXPECT_LT(e.in_plane_mm, 0.1);
  EXPECT_LT(e.z_mm, 0.001);
  EXPECT_LT(e.tilt_deg, 0.001);
  // No turn was invented.
  EXPECT_LT(test::pose_error(p.result->work_T_object, start).turn_deg, 0.01);
}

TEST(Polish, PointsOfNoSpreadTakeNoPart) {
  model::Template part = rectangle();
  for (int i = 0; i < part.contour_count; i += 2) part.contour[i].spread_mm = -1.0F;
  const auto p = polished(part, rectangle_scan(1.0, 0.0), kTruth);
  ASSERT_TRUE(p.result);
  EXPECT_LE(p.result->crossing_count, part.contour_count / 2);
  for (int i = 0; i < part.contour_count; i += 2) EXPECT_FALSE(p.scratch.crossings[i].found);
  for (model::ContourPoint& c : part.contour) c.spread_mm = -1.0F;
  EXPECT_EQ(polished(part, rectangle_scan(1.0, 0.0), kTruth).result.status(),
            Status::kTooFewPoints);
}

TEST(Polish, ReportsTooFewPoints) {
  const MadeScan floor(90, 80, 1.0, [](double, double) { return 0.0; });
  EXPECT_EQ(polished(rectangle(), floor, kTruth).result.status(), Status::kTooFewPoints);
  const Pose outside = test::pose_at(500.0, 500.0, kTop_mm);
  EXPECT_EQ(polished(rectangle(), rectangle_scan(1.0, 0.0), outside).result.status(),
            Status::kTooFewPoints);
}

}  // namespace
}  // namespace flatpose::refine
