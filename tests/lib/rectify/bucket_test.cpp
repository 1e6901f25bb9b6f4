#include "flatpose/rectify/bucket.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "tests/lib/rectify/scan_fixture.hpp"

namespace flatpose::rectify {
namespace {

void bucket_ok(const Scan& scan, const Pose& work_T_scan, Map& map) {
  Scratch scratch(bucket_required_bytes(scan.width_px, scan.height_px, map.map.grid));
  ASSERT_EQ(bucket(scan.view(), work_T_scan, scratch.arena, map.map), Status::kOk);
  ASSERT_EQ(scratch.arena.used_bytes(), 0U);
}

TEST(Bucket, EqualsASortOfEveryCell) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const Pose scan_T_work = random_pose(random, 3.0);
    const double spread_mm = uniform(random, 1, 20);
    const bool ties = random() % 2 == 0;
    const int width = static_cast<int>(random() % 30), height = static_cast<int>(random() % 20);
    const Scan scan(width, height, ties ? Pose{} : scan_T_work, [&](int, int) {
      Vec3 p{uniform(random, -spread_mm, spread_mm), uniform(random, -spread_mm, spread_mm),
             uniform(random, 0, 4)};
      if (ties) p.z = std::floor(p.z);
      if (random() % 8 == 0) p.x = std::nan("");
      return p;
    });
    const Pose work_T_scan = ties ? Pose{} : scan_T_work.inverse();
    Map map(Grid{uniform(random, -10, 0), uniform(random, -10, 0), uniform(random, 0.3, 5), 9, 7});
    bucket_ok(scan, work_T_scan, map);

    std::map<std::pair<int, int>, std::vector<std::pair<float, int>>> cells;
    for (int i = 0; i < width * height; ++i) {
      const Vec3 p = work_T_scan * scan.view()(i % width, i / width);
      if (!is_valid(p)) continue;
      const int column = static_cast<int>(std::floor(map.map.grid.column_of(p.x) + 0.5));
      const int row = static_cast<int>(std::floor(map.map.grid.row_of(p.y) + 0.5));
      cells[{column, row}].push_back({static_cast<float>(p.z), i});
    }
    for (int row = 0; row < 7; ++row) {
      for (int column = 0; column < 9; ++column) {
        auto& points = cells[{column, row}];
        ASSERT_EQ(map.seen(column, row), !points.empty()) << trial;
        if (points.empty()) continue;
        std::sort(points.begin(), points.end());
        const auto [z_mm, source] = points[(points.size() - 1) / 2];
        ASSERT_NEAR(map.height_mm(column, row), z_mm, 1e-5) << trial;
        ASSERT_EQ(map.source(column, row), source) << trial;
      }
    }
  }
}

TEST(Bucket, KeepsLonePointsAndSingleRows) {
  const Scan scan(5, 1, {}, [](int c, int) { return Vec3{2.0 * c, 0.2, 1.0 * c}; });
  Map map(Grid{0, 0, 1.0, 9, 2});
  bucket_ok(scan, {}, map);
  EXPECT_EQ(map.seen_count(), 5);
  EXPECT_EQ(map.height_mm(4, 0), 2.0F);
  EXPECT_EQ(map.source(4, 0), 2);
}

TEST(Bucket, RefusesWhatItCannotUse) {
  const Scan scan(4, 4);
  Map map(Grid{0, 0, 1.0, 5, 5});
  Scratch small(bucket_required_bytes(4, 4, map.map.grid) - 70);
  EXPECT_EQ(bucket(scan.view(), {}, small.arena, map.map), Status::kOutOfMemory);
  Scratch scratch(bucket_required_bytes(4, 4, map.map.grid));
  HeightMap wrong = map.map;
  wrong.source_index.width_px = 4;
  EXPECT_EQ(bucket(scan.view(), {}, scratch.arena, wrong), Status::kShapeMismatch);
  EXPECT_EQ(map.height_mm(0, 0), 777.0F);
}

}  // namespace
}  // namespace flatpose::rectify
