#include "flatpose/rectify/survey.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lib/rectify/scan_fixture.hpp"

namespace flatpose::rectify {
namespace {

Result<Survey> survey_of(const Scan& scan, const Pose& work_T_scan = {}) {
  Scratch scratch(survey_required_bytes());
  return survey(scan.view(), work_T_scan, scratch.arena);
}

/// Sum of twelve uniform numbers: near enough a normal distribution.
double normal(std::mt19937& random, double sigma) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += uniform(random, 0, 1);
  return sigma * sum;
}

TEST(Survey, MeasuresPitchNoiseAndLossDespiteJumps) {
  std::mt19937 random(2);
  for (const double sigma_mm : {0.05, 0.4}) {
    const Pose scan_T_work = looking_down(400);
    const Scan scan(300, 200, scan_T_work, [&](int c, int r) {
      const double block_mm = (c / 100 + r / 100) % 2 == 0 ? 0.0 : 9.0;
      Vec3 p{0.7 * c, 1.3 * r, 0.2 * (0.7 * c) + block_mm + normal(random, sigma_mm)};
      if (random() % 10 == 0) p.z = std::nan("");
      return p;
    });
    const auto result = survey_of(scan, scan_T_work.inverse());
    ASSERT_TRUE(result);
    EXPECT_NEAR(result->pitch_along_row_mm, 0.7, 1e-3);
    EXPECT_NEAR(result->pitch_along_column_mm, 1.3, 1e-3);
    EXPECT_NEAR(result->noise_sigma_mm, sigma_mm, 0.08 * sigma_mm);
    EXPECT_NEAR(result->missing_share, 0.1, 0.01);
    EXPECT_EQ(result->point_count, 60000);
    EXPECT_EQ(result->valid_count, std::lround(60000 * (1 - result->missing_share)));
  }
}

TEST(Survey, SeesTheNoiseThatASensorSmoothsAlongItsLine) {
  for (const bool along_rows : {true, false}) {
    std::mt19937 random(3);
    std::vector<double> raw_mm(302 * 302);
    for (double& z_mm : raw_mm) z_mm = normal(random, 0.3);
    const int lag = along_rows ? 1 : 302;
    const Scan scan(300, 300, {}, [&](int c, int r) {
      const double* const z_mm = &raw_mm[(r + 1) * 302 + c + 1];
      return Vec3{1.0 * c, 1.0 * r, (z_mm[-lag] + z_mm[0] + z_mm[lag]) / 3.0};
    });
    EXPECT_NEAR(survey_of(scan)->noise_sigma_mm, 0.3 / std::sqrt(3.0), 0.01);
  }
}

TEST(Survey, NoiseStaysCloseWhenHeightsComeInSteps) {
  std::mt19937 random(9);
  for (const double step_mm : {0.03, 0.06, 0.1}) {
    const Scan scan(300, 300, {}, [&](int c, int r) {
      const double z_mm = normal(random, 0.1) + 0.013 * c;
      return Vec3{1.0 * c, 1.0 * r, step_mm * std::floor(z_mm / step_mm + 0.5)};
    });
    EXPECT_NEAR(survey_of(scan)->noise_sigma_mm, 0.1, 0.02) << step_mm;
  }
}

TEST(Survey, BoxHoldsEveryPointTightlyUnderAnyPose) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const int width = 1 + static_cast<int>(random() % 40),
              height = 1 + static_cast<int>(random() % 9);
    const Pose work_T_scan = random_pose(random, 3.0);
    const Scan scan(width, height, {}, [&](int, int) {
      Vec3 p{uniform(random, -99, 99), uniform(random, -99, 99), uniform(random, 0, 500)};
      if (random() % 4 == 0) p.y = std::nan("");
      return p;
    });
    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    int count = 0;
    for (int i = 0; i < width * height; ++i) {
      const Vec3 p = work_T_scan * scan.view()(i % width, i / width);
      if (!is_valid(p)) continue;
      ++count;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const auto result = survey_of(scan, work_T_scan);
    ASSERT_TRUE(result);
    ASSERT_EQ(result->valid_count, count) << trial;
    if (count == 0) continue;
    ASSERT_LT(norm(result->min_mm - low) + norm(result->max_mm - high), 1e-3) << trial;
  }
}

TEST(Survey, TakesAScanWithoutPointsAsEmpty) {
  const Scan scan(30, 20, {}, [](int, int) { return Vec3{std::nan(""), 0, 0}; });
  const auto result = survey_of(scan);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->valid_count, 0);
  EXPECT_EQ(result->missing_share, 1.0);
  EXPECT_EQ(result->pitch_along_row_mm, 0.0);
  EXPECT_EQ(result->noise_sigma_mm, 0.0);
  EXPECT_EQ(result->max_mm, Vec3{});
  EXPECT_EQ(choose_grid(*result, {}).status(), Status::kTooFewPoints);
  EXPECT_TRUE(survey_of(Scan(0, 0)));
}

TEST(Survey, SeesPitchAlongSingleRowsAndColumns) {
  const auto point = [](int c, int r) { return Vec3{0.5 * c, 0.25 * r, 0}; };
  const auto row = survey_of(Scan(99, 1, {}, point));
  EXPECT_EQ(row->pitch_along_row_mm, 0.5);
  EXPECT_EQ(row->pitch_along_column_mm, 0.0);
  const auto column = survey_of(Scan(1, 99, {}, point));
  EXPECT_EQ(column->pitch_along_row_mm, 0.0);
  EXPECT_EQ(column->pitch_along_column_mm, 0.25);
}

TEST(Survey, RefusesInfiniteAndGiantCoordinates) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float wild : {infinity, -infinity, 2e6F, -3e38F}) {
    for (int i = 0; i < 3 * 13 * 3; ++i) {
      Scan scan(13, 3);
      scan.xyz_mm[i] = wild;
      ASSERT_EQ(survey_of(scan).status(), Status::kNotFinite) << wild << " at " << i;
    }
  }
}

TEST(Survey, RefusesTooLittleScratchAndBadPoses) {
  const Scan scan(5, 5);
  Scratch scratch(survey_required_bytes() - 70);
  EXPECT_EQ(survey(scan.view(), {}, scratch.arena).status(), Status::kOutOfMemory);
  Pose pose;
  pose.rotation.m[4] = std::nan("");
  EXPECT_EQ(survey_of(scan, pose).status(), Status::kNotFinite);
  EXPECT_EQ(survey_of(scan, {{}, {1e300, 0, 0}}).status(), Status::kInvalidArgument);
}

TEST(Survey, ReadsStridedViewsAlike) {
  std::mt19937 random(6);
  const Scan scan(37, 5, {}, [&](int c, int r) {
    return Vec3{1.0 * c + uniform(random, 0, 1), 1.0 * r, uniform(random, 0, 1)};
  });
  const auto expected = survey_of(scan);
  for (const int stride : {1, 4}) {
    const int row_floats = 37 * stride + 2, plane = stride == 1 ? 5 * row_floats : 1;
    std::vector<float> padded(static_cast<std::size_t>(3 * 5 * row_floats), kNan);
    for (int i = 0; i < 37 * 5; ++i) {
      for (int k = 0; k < 3; ++k)
        padded[i / 37 * row_floats + i % 37 * stride + k * plane] = scan.xyz_mm[3 * i + k];
    }
    const float* const p = padded.data();
    const RangeImageView view{p, p + plane, p + 2 * plane, 37, 5, 4 * stride, 4 * row_floats};
    Scratch scratch(survey_required_bytes());
    const auto result = survey(view, {}, scratch.arena);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->valid_count, 37 * 5);
    EXPECT_EQ(result->max_mm, expected->max_mm);
    EXPECT_EQ(result->noise_sigma_mm, expected->noise_sigma_mm);
  }
}

Survey box_survey(Vec3 low, Vec3 high) {
  Survey survey;
  survey.point_count = survey.valid_count = 100;
  survey.min_mm = low;
  survey.max_mm = high;
  return survey;
}

TEST(ChooseGrid, CoversTheBoxOnALatticeOfItsOwn) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 low{uniform(random, -50, 50), uniform(random, -50, 50), 0};
    const Vec3 high = low + Vec3{uniform(random, 0, 50), uniform(random, 0, 50), 0};
    const double cell_mm = uniform(random, 0.2, 5), margin_mm = uniform(random, 0, 3);
    const auto grid =
        choose_grid(box_survey(low, high), {.cell_mm = cell_mm, .margin_mm = margin_mm});
    ASSERT_TRUE(grid);
    const double left = grid->x_of(-0.5), right = grid->x_of(grid->width_px - 0.5);
    ASSERT_LE(left, low.x - margin_mm + 1e-9);
    ASSERT_GT(left, low.x - margin_mm - cell_mm - 1e-9);
    ASSERT_GE(right, high.x + margin_mm - 1e-9);
    ASSERT_LE(right, high.x + margin_mm + cell_mm + 1e-9);
    ASSERT_GE(grid->y_of(grid->height_px - 0.5), high.y + margin_mm - 1e-9);
    ASSERT_NEAR(left / cell_mm, std::floor(left / cell_mm + 0.5), 1e-6);
  }
}

TEST(ChooseGrid, LooksOnlyIntoTheRegion) {
  const Survey survey = box_survey({0, 0, 0}, {100, 50, 0});
  const auto grid = choose_grid(survey, {.region = {10.2, -5, 20.2, 5.5}});
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->x0_mm, 10.5);
  EXPECT_EQ(grid->width_px, 11);
  EXPECT_EQ(grid->y0_mm, 0.5);
  EXPECT_EQ(grid->height_px, 6);
  EXPECT_EQ(choose_grid(survey, {.region = {101, 0, 120, 5}}).status(), Status::kTooFewPoints);
}

TEST(ChooseGrid, BoundsTheField) {
  const Survey survey = box_survey({0, 0, 0}, {1000, 500, 0});
  EXPECT_TRUE(choose_grid(survey, {.cells_max = 1001 * 501}));
  EXPECT_EQ(choose_grid(survey, {.cells_max = 1001 * 501 - 1}).status(), Status::kTooLarge);
  EXPECT_EQ(choose_grid(survey, {.cell_mm = 0.02}).status(), Status::kTooLarge);
  EXPECT_EQ(choose_grid(survey, {.cell_mm = 1e-5}).status(), Status::kTooLarge);
  EXPECT_EQ(choose_grid(survey, {.cell_mm = 0}).status(), Status::kInvalidArgument);
  EXPECT_EQ(choose_grid(survey, {.cell_mm = std::nan("")}).status(), Status::kInvalidArgument);
  EXPECT_EQ(choose_grid(survey, {.region = {5, 5, 4, 6}}).status(), Status::kInvalidArgument);
}

}  // namespace
}  // namespace flatpose::rectify
