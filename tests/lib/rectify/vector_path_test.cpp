// Every form of the loops over a scan gives the same bits.

#include "port/linux/cpu/vector_path.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "flatpose/rectify/paint.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"

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

}  // namespace
}  // namespace flatpose::rectify
