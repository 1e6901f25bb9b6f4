// Every form of the loops over a scan gives the same bits.

#include "port/linux/cpu/vector_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "flatpose/rectify/paint.hpp"
#include "flatpose/rectify/survey.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::rectify {
namespace {

/// Steps, slopes, lost and wild points, under any pose, at any ratio of pitch and cell.
Scan rough_scan(std::mt19937& random, int width, int height, double pitch_mm,
                const Pose& scan_T_work) {
  const double slope = uniform(random, -1, 1);
  Scan scan(width, height, scan_T_work, [&](int c, int r) {
    const double step_mm = (c / 7 + r / 5) % 3 == 0 ? 6.0 : 0.0;
    return Vec3{(c + uniform(random, -0.3, 0.3)) * pitch_mm,
                (r + uniform(random, -0.3, 0.3)) * pitch_mm,
                step_mm + slope * pitch_mm * c + uniform(random, -0.5, 0.5)};
  });
  for (int i = 0; i < width * height / 20; ++i) {
    const int c = static_cast<int>(random() % static_cast<unsigned>(width));
    const int r = static_cast<int>(random() % static_cast<unsigned>(height));
    if (i % 5 == 0) {
      scan.set(c, r, {uniform(random, -1e7, 1e7), uniform(random, -1e7, 1e7), 1e9});
    } else {
      scan.lose(c, r);
    }
  }
  return scan;
}

TEST(RowKernels, EveryPathPaintsTheSameBits) {
  std::mt19937 random(7);
  const VectorPath best = port::best_vector_path();
  int seen_count = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int width = 1 + static_cast<int>(random() % 150U);
    const Pose scan_T_work = trial % 2 == 0 ? looking_down(40.0) : random_pose(random, 0.8);
    const Scan scan = rough_scan(random, width, 23, uniform(random, 0.3, 2.5), scan_T_work);
    const Grid grid{uniform(random, -5, 5), uniform(random, -5, 5), uniform(random, 0.5, 1.5), 90,
                    40};
    PaintConfig config{.jump_mm = 2, .max_slope = 1, .max_gap_mm = uniform(random, 2, 20)};
    Scratch scratch(paint_required_bytes(width));
    Map portable(grid);
    ASSERT_EQ(paint(scan.view(), scan_T_work.inverse(), config, scratch.arena, portable.map),
              Status::kOk);
    seen_count += portable.seen_count();
    for (const VectorPath path : {VectorPath::kAvx2, VectorPath::kAvx512}) {
      if (path > best) continue;
      config.vector_path = path;
      Map wide(grid);
      ASSERT_EQ(paint(scan.view(), scan_T_work.inverse(), config, scratch.arena, wide.map),
                Status::kOk);
      ASSERT_EQ(wide.sources, portable.sources) << trial;
      for (std::size_t i = 0; i < wide.heights_mm.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(wide.heights_mm[i]),
                  std::bit_cast<std::uint32_t>(portable.heights_mm[i]))
            << trial;
      }
    }
  }
  EXPECT_GT(seen_count, 10000);
}

// As if the rows and columns between had never been scanned, but for the pixels' numbers.
TEST(Paint, ReadsEverySoManyRowsAndColumns) {
  std::mt19937 random(9);
  for (int trial = 0; trial < 40; ++trial) {
    const int step = 1 + trial % 5;
    const int width = step + 1 + static_cast<int>(random() % 150U);
    const int height = step + 1 + static_cast<int>(random() % 40U);
    const Scan scan = rough_scan(random, width, height, 1.0 / step, looking_down(40.0));
    Scan thin((width + step - 1) / step, (height + step - 1) / step);
    for (int r = 0; r < thin.height_px; ++r) {
      for (int c = 0; c < thin.width_px; ++c) thin.set(c, r, scan.view()(c * step, r * step));
    }
    const Grid grid{-2, -2, 1, 40, 30};
    PaintConfig config{.jump_mm = 2, .max_slope = 1, .max_gap_mm = 4};
    Scratch scratch(paint_required_bytes(width));
    Map expected(grid);
    ASSERT_EQ(paint(thin.view(), looking_down(40.0).inverse(), config, scratch.arena, expected.map),
              Status::kOk);
    config.step_px = step;
    for (const VectorPath path : vector_paths()) {
      config.vector_path = path;
      Map map(grid);
      ASSERT_EQ(paint(scan.view(), looking_down(40.0).inverse(), config, scratch.arena, map.map),
                Status::kOk);
      for (int row = 0; row < grid.height_px; ++row) {
        for (int column = 0; column < grid.width_px; ++column) {
          ASSERT_EQ(map.seen(column, row), expected.seen(column, row)) << trial;
          const int of_thin = expected.source(column, row);
          if (!map.seen(column, row)) continue;
          ASSERT_EQ(map.height_mm(column, row), expected.height_mm(column, row));
          ASSERT_EQ(map.source(column, row),
                    of_thin / thin.width_px * step * width + of_thin % thin.width_px * step);
        }
      }
    }
  }
}

TEST(RowKernels, EveryPathSurveysTheSameBits) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 40; ++trial) {
    const int width = 1 + static_cast<int>(random() % 90U);
    const Pose scan_T_work = random_pose(random, 0.8);
    Scan scan = rough_scan(random, width, 11, uniform(random, 0.3, 2.5), scan_T_work);
    for (float& coordinate_mm : scan.xyz_mm) coordinate_mm = std::min(coordinate_mm, 1e5F);
    for (float& coordinate_mm : scan.xyz_mm) coordinate_mm = std::max(coordinate_mm, -1e5F);
    Vec3 low{1e9, 1e9, 1e9};
    int valid_count = 0;
    for (int i = 0; i < width * 11; ++i) {
      const float* const p = &scan.xyz_mm[3U * static_cast<std::size_t>(i)];
      if (std::isnan(p[0])) continue;
      const Vec3 w = scan_T_work.inverse() * Vec3{p[0], p[1], p[2]};
      low = {std::min(low.x, w.x), std::min(low.y, w.y), std::min(low.z, w.z)};
      ++valid_count;
    }
    // Side by side, apart, and strided.
    const RangeImageView triples = scan.view();
    std::vector<float> planes[3];
    for (std::size_t i = 0; i < scan.xyz_mm.size(); ++i) planes[i % 3].push_back(scan.xyz_mm[i]);
    const RangeImageView apart{planes[0].data(), planes[1].data(), planes[2].data(), width, 11, 4,
                               4L * width};
    std::vector<float> wide(5 * planes[0].size());
    for (std::size_t i = 0; i < scan.xyz_mm.size(); ++i) wide[i / 3 * 5 + i % 3] = scan.xyz_mm[i];
    const RangeImageView strided{wide.data(), wide.data() + 1, wide.data() + 2, width, 11,
                                 20,          20L * width};
    Scratch scratch(survey_required_bytes());
    const auto first = survey(triples, scan_T_work.inverse(), scratch.arena);
    ASSERT_TRUE(first);
    ASSERT_EQ(first->valid_count, valid_count);
    if (valid_count > 0) {
      ASSERT_NEAR(first->min_mm.x, low.x, 1e-6 * std::fabs(low.x) + 0.05);
      ASSERT_NEAR(first->min_mm.z, low.z, 1e-6 * std::fabs(low.z) + 0.05);
    }
    for (const VectorPath path : vector_paths()) {
      for (const RangeImageView& view : {triples, apart, strided}) {
        const auto other = survey(view, scan_T_work.inverse(), scratch.arena, path);
        ASSERT_TRUE(other);
        ASSERT_EQ(other->valid_count, first->valid_count);
        for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
          ASSERT_EQ(other->min_mm.*axis, first->min_mm.*axis);
          ASSERT_EQ(other->max_mm.*axis, first->max_mm.*axis);
        }
        ASSERT_EQ(other->noise_sigma_mm, first->noise_sigma_mm);
      }
    }
  }
}

}  // namespace
}  // namespace flatpose::rectify
