#include <gtest/gtest.h>

#include <array>

#include "flatpose/rectify/scan_row.hpp"
#include "flatpose/rectify/triangle.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"

namespace flatpose::rectify {
namespace {

// Also folded ones, ones without area, ones beyond the map and ones whose diagonal meets a centre.
TEST(PaintQuad, IsItsTwoTrianglesOneAfterTheOther) {
  std::mt19937 random(3);
  const auto place = [&](int cells) {
    const auto units = static_cast<std::int32_t>(uniform(random, -1, cells) * kUnitsPerCell);
    return random() % 4 == 0 ? kUnitsPerCell * (units / kUnitsPerCell) + 1 : units | 1;
  };
  const Grid grid{0, 0, 1, 6, 5};
  int painted_count = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<Corner, 4> p;
    for (int i = 0; i < 4; ++i) {
      p[i] = {place(trial % 2 == 0 ? 7 : 3), place(trial % 2 == 0 ? 6 : 3),
              static_cast<float>(uniform(random, -9, 9)), 10 + i};
    }
    if (trial % 7 == 0) p[3] = p[1];
    if (trial % 11 == 0) p[1] = p[0];
    Map triangles(grid);
    Map quad(grid);
    clear(triangles.map);
    clear(quad.map);
    paint_triangle(triangles.map, p[0], p[1], p[2]);
    paint_triangle(triangles.map, p[0], p[2], p[3]);
    paint_quad(quad.map, p[0], p[1], p[2], p[3]);
    painted_count += quad.seen_count();
    ASSERT_EQ(quad.sources, triangles.sources) << trial;
    for (int row = 0; row < grid.height_px; ++row) {
      for (int column = 0; column < grid.width_px; ++column) {
        if (!quad.seen(column, row)) continue;
        ASSERT_EQ(quad.height_mm(column, row), triangles.height_mm(column, row)) << trial;
      }
    }
  }
  EXPECT_GT(painted_count, 20000);
}

}  // namespace
}  // namespace flatpose::rectify
