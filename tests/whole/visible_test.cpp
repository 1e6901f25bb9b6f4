// The visible share that a match reports, against the share that laser and camera both see by the
// simulator's own rays.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/lib/locate/small_parts.hpp"

namespace flatpose::locate {
namespace {

using test::SharedPart;

struct Shares {
  double truth;
  double told;
};

/// A board held level over the field, its near side `reach_mm` beyond the field's middle toward
/// `side_rad`.
sim::Instance cover(double side_rad, double reach_mm, double height_mm) {
  constexpr double kSide_mm = 70.0;
  static const SharedPart board =
      test::made({.name = "board", .outline = {}, .thickness_mm = 2.0, .areas = {}},
                 sim::rectangle({}, kSide_mm, kSide_mm));
  const auto [s, c] = sin_cos(side_rad);
  const double away_mm = 0.5 * kSide_mm - reach_mm;
  return {board, {rotation_about_z(side_rad), {away_mm * c, away_mm * s, height_mm}}};
}

/// Covers of any size from any side at any height.
std::vector<Shares> shares(const SharedPart& part, double noise_mm, int count, int* shown_count) {
  const sim::SensorConfig sensor = test::small_sensor(noise_mm);
  const test::Lesson lesson = test::lesson(part, sensor);
  test::Locating locating(test::small_field_limits());
  LocateConfig config;
  config.min_visible = 0.3;
  std::vector<Shares> all;
  *shown_count = 0;
  std::mt19937_64 generator(1);
  const auto drawn = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
  };
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = 500 + static_cast<std::uint64_t>(i);
    const sim::SimulatedScan scan =
        test::shot(part, test::pose_by_lot(*part, seed), sensor, seed,
                   {cover(drawn(-kPi, kPi), drawn(-20.0, 10.0), drawn(20.0, 40.0))});
    EXPECT_EQ(locating.run(lesson.part, scan.view(), config), Status::kOk);
    const double truth = scan.instances.front().visible;
    *shown_count += truth > 0.4 ? 1 : 0;
    if (locating.result.match_count > 0) all.push_back({truth, locating.result.matches[0].visible});
  }
  return all;
}

class Visible : public testing::TestWithParam<double> {};

TEST_P(Visible, IsTheShareThatLaserAndCameraSee) {
  int shown_count = 0;
  const std::vector<Shares> all = shares(test::small_ell(), GetParam(), 100, &shown_count);
  // A few are found with less than half of their contour open; nearly all that show enough are.
  EXPECT_GE(static_cast<int>(all.size()), shown_count * 9 / 10);
  std::vector<double> errors;
  std::vector<double> truths;
  for (const Shares& s : all) {
    errors.push_back(std::fabs(s.told - s.truth));
    truths.push_back(s.truth);
  }
  std::sort(errors.begin(), errors.end());
  std::sort(truths.begin(), truths.end());
  const std::size_t count = errors.size();
  EXPECT_LT(errors[count / 2], 0.025);
  EXPECT_LT(errors[count * 95 / 100], 0.08);
  EXPECT_LT(errors.back(), 0.25);
  // There was something to tell apart: a quarter showed hardly half of itself, some all.
  EXPECT_LT(truths[count / 4], 0.55);
  EXPECT_GT(truths.back(), 0.98);
}

INSTANTIATE_TEST_SUITE_P(Noises, Visible, testing::Values(0.05, 0.3), [](const auto& made) {
  return "hundredths_mm_" + std::to_string(std::lround(100.0 * made.param));
});

}  // namespace
}  // namespace flatpose::locate
