// A scan surveyed and painted in parts, in any order and side by side, comes out in the same bits.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "flatpose/rectify/paint.hpp"
#include "flatpose/rectify/survey.hpp"
#include "tests/lib/image/executors.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::rectify {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Notes into how many parts the last stage was cut.
class CountingExecutor final : public Executor {
 public:
  int last_count = 0;
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    last_count = chunk_count;
    for (int i = 0; i < chunk_count; ++i) task(context, i);
  }
};

Pose turned(double turn_rad, double lean_rad) {
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const double lc = std::cos(lean_rad), ls = std::sin(lean_rad);
  Pose pose;
  pose.rotation.m = {c, -s * lc, s * ls, s, c * lc, -c * ls, 0, ls, lc};
  pose.position_mm = {30.0, -20.0, 5.0};
  return pose;
}

/// Steps and noise, with lost points.
Scan stepped_scan(std::mt19937& random, int width, int height, const Pose& scan_T_work) {
  Scan scan(width, height, scan_T_work, [&](int c, int r) {
    const double step_mm = (c / 9 + r / 11) % 3 == 0 ? 6.0 : 0.0;
    return Vec3{c + uniform(random, -0.2, 0.2), r + uniform(random, -0.2, 0.2),
                step_mm + uniform(random, -0.3, 0.3)};
  });
  for (int i = 0; i < width * height / 15; ++i) {
    scan.lose(static_cast<int>(random() % static_cast<unsigned>(width)),
              static_cast<int>(random() % static_cast<unsigned>(height)));
  }
  return scan;
}

bool same(const Map& a, const Map& b, const Grid& grid) {
  for (int row = 0; row < grid.height_px; ++row) {
    for (int column = 0; column < grid.width_px; ++column) {
      if (a.source(column, row) != b.source(column, row)) return false;
      if (a.seen(column, row) != b.seen(column, row)) return false;
      if (a.seen(column, row) && std::bit_cast<std::uint32_t>(a.height_mm(column, row)) !=
                                     std::bit_cast<std::uint32_t>(b.height_mm(column, row))) {
        return false;
      }
    }
  }
  return true;
}

TEST(PaintChunks, GiveTheSameMapWhoeverPaintsThem) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 24; ++trial) {
    // Rows along x, along y, both ways, leaning, and aslant.
    const double turn_rad = trial % 6 == 5 ? uniform(random, 0, 2 * kPi) : trial % 6 * kPi / 2;
    const Pose work_T_scan = turned(turn_rad, trial % 4 == 3 ? 0.2 : 0.0);
    const int height = 120 + trial * 30;
    const Scan scan = stepped_scan(random, 90, height, work_T_scan.inverse());
    Scratch survey_scratch(survey_required_bytes());
    const auto seen = survey(scan.view(), work_T_scan, survey_scratch.arena);
    ASSERT_TRUE(seen);
    const auto grid = choose_grid(*seen, {.cell_mm = uniform(random, 0.8, 1.3)});
    ASSERT_TRUE(grid);
    PaintConfig config{.jump_mm = 2, .max_slope = 1, .max_gap_mm = 4, .step_px = 1 + trial % 2};
    Scratch scratch(paint_required_bytes(90));
    Map expected(*grid);
    ASSERT_EQ(paint(scan.view(), work_T_scan, config, scratch.arena, expected.map), Status::kOk);
    EXPECT_GT(expected.seen_count(), 5000);
    config.reach = &seen->reach;
    CountingExecutor counting;
    Map counted(*grid);
    ASSERT_EQ(paint(scan.view(), work_T_scan, config, scratch.arena, counted.map, counting),
              Status::kOk);
    if (trial % 6 < 4 && height > 400) {
      EXPECT_GT(counting.last_count, 4) << trial;
    }
    for (const VectorPath path : vector_paths()) {
      config.vector_path = path;
      for_each_executor([&](Executor& executor) {
        Map map(*grid);
        ASSERT_EQ(paint(scan.view(), work_T_scan, config, scratch.arena, map.map, executor),
                  Status::kOk);
        ASSERT_TRUE(same(map, expected, *grid)) << trial;
      });
    }
  }
}

TEST(SurveyChunks, GiveTheSameSurveyWhoeverLooks) {
  std::mt19937 random(12);
  for (const int height : {1, 2, 7, 64, 130, 600, 1100}) {
    const Scan scan = stepped_scan(random, 70, height, turned(0.3, 0.1).inverse());
    Scratch scratch(survey_required_bytes());
    const auto expected = survey(scan.view(), turned(0.3, 0.1), scratch.arena);
    ASSERT_TRUE(expected);
    for_each_executor([&](Executor& executor) {
      const auto found =
          survey(scan.view(), turned(0.3, 0.1), scratch.arena, VectorPath::kPortable, executor);
      ASSERT_TRUE(found);
      EXPECT_EQ(found->valid_count, expected->valid_count);
      EXPECT_EQ(found->min_mm.x, expected->min_mm.x);
      EXPECT_EQ(found->max_mm.z, expected->max_mm.z);
      EXPECT_EQ(found->pitch_along_row_mm, expected->pitch_along_row_mm);
      EXPECT_EQ(found->pitch_along_column_mm, expected->pitch_along_column_mm);
      EXPECT_EQ(found->noise_sigma_mm, expected->noise_sigma_mm);
    });
  }
}

}  // namespace
}  // namespace flatpose::rectify
