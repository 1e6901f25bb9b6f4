// Quads painted many at a time come out as those painted triangle by triangle, on every path.

#include "flatpose/rectify/quad_strip.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "flatpose/rectify/row_kernels.hpp"
#include "flatpose/rectify/triangle.hpp"
#include "tests/lib/rectify/scan_fixture.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::rectify {
namespace {

/// Two rows of corners, of any shape: folded, wide, without area, some of them lost.
struct Rows {
  static constexpr int kCountMax = 100;
  std::array<std::int32_t, kCountMax + 1 + kRowPadding> u[2], v[2];
  std::array<float, kCountMax + 1 + kRowPadding> z_mm[2];
  int count;

  Rows(std::mt19937& random, int quad_count, double pitch_px) : count(quad_count) {
    const auto odd = [](double cells) {
      return static_cast<std::int32_t>(cells * kUnitsPerCell) | 1;
    };
    for (int r = 0; r < 2; ++r) {
      z_mm[r].fill(kNan);
      u[r].fill(0);
      v[r].fill(0);
      for (int i = 0; i <= count; ++i) {
        u[r][i] = odd(i * pitch_px + uniform(random, -0.4, 0.4));
        v[r][i] = odd(2.6 + r * pitch_px + uniform(random, -0.4, 0.4));
        if (random() % 20 != 0) z_mm[r][i] = static_cast<float>(uniform(random, -1.2, 1.2));
      }
    }
  }
  [[nodiscard]] QuadStrip strip() const {
    return {u[0].data(), v[0].data(), z_mm[0].data(),
            u[1].data(), v[1].data(), z_mm[1].data(),
            count,       500,         2,
            300};
  }
};

Corner corner(const Rows& rows, int row, int i) {
  return {rows.u[row][i], rows.v[row][i], rows.z_mm[row][i], 500 + 2 * i + 300 * row};
}

bool holds(const EdgeLimits& limits, const Corner& p, const Corner& q) {
  const double x = q.u - p.u, y = q.v - p.v;
  const double beyond_mm = std::fabs(static_cast<double>(q.z_mm - p.z_mm)) - limits.jump_mm;
  const double squared = x * x + y * y;
  return squared <= limits.gap_squared &&
         (beyond_mm <= 0 || beyond_mm * beyond_mm <= limits.slope_squared * squared);
}

/// The triangles as paint.hpp has them.
void paint_plainly(const Rows& rows, const EdgeLimits& limits, const HeightMap& map) {
  for (int i = 0; i < rows.count; ++i) {
    const Corner a = corner(rows, 0, i), b = corner(rows, 0, i + 1);
    const Corner c = corner(rows, 1, i + 1), d = corner(rows, 1, i);
    const auto paint = [&](const Corner& p, const Corner& q, const Corner& r, bool really) {
      const bool all = holds(limits, p, q) && holds(limits, q, r) && holds(limits, p, r);
      if (all && really) paint_triangle(map, p, q, r);
      return all;
    };
    const bool first = paint(a, b, c, true) | paint(a, c, d, true);
    paint(a, b, d, !first);
    paint(b, c, d, !first);
  }
}

TEST(QuadStrip, IsPaintedAsItsTriangles) {
  std::mt19937 random(11);
  const Grid grid{0, 0, 1, 70, 9};
  int seen_count = 0, left_count = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Rows rows(random, 1 + trial % Rows::kCountMax, uniform(random, 0.3, 2.4));
    const EdgeLimits limits{
        0.9F, 1e-8F, static_cast<float>(uniform(random, 1.0, 9.0) * kUnitsPerCell * kUnitsPerCell)};
    Map expected(grid);
    clear(expected.map);
    paint_plainly(rows, limits, expected.map);
    for (const VectorPath path : vector_paths()) {
      Map painted(grid);
      clear(painted.map);
      std::array<std::int32_t, Rows::kCountMax + kRowPadding> memory[4];
      QuadList several{memory[0].data(), memory[1].data(), 0};
      QuadList rest{memory[2].data(), memory[3].data(), 0};
      const RowKernels& kernels = row_kernels(path);
      kernels.paint_single_cells(rows.strip(), limits, MapCells(painted.map), several);
      kernels.paint_several_cells(rows.strip(), MapCells(painted.map), several, rest);
      for (int k = 0; k < rest.count; ++k) {
        const int i = rest.quad[k];
        const std::int32_t edges = rest.edges[k];
        const Corner a = corner(rows, 0, i), b = corner(rows, 0, i + 1);
        const Corner c = corner(rows, 1, i + 1), d = corner(rows, 1, i);
        const auto has = [&](std::int32_t wanted) { return (edges & wanted) == wanted; };
        const bool abc = has(kAb | kBc | kAc), acd = has(kAc | kCd | kAd);
        if (abc) paint_triangle(painted.map, a, b, c);
        if (acd) paint_triangle(painted.map, a, c, d);
        if (!abc && !acd && has(kAb | kBd | kAd)) paint_triangle(painted.map, a, b, d);
        if (!abc && !acd && has(kBc | kCd | kBd)) paint_triangle(painted.map, b, c, d);
      }
      left_count += several.count;
      seen_count += painted.seen_count();
      for (int row = 0; row < grid.height_px; ++row) {
        for (int column = 0; column < grid.width_px; ++column) {
          ASSERT_EQ(painted.seen(column, row), expected.seen(column, row)) << trial;
          if (!expected.seen(column, row)) continue;
          ASSERT_NEAR(painted.height_mm(column, row), expected.height_mm(column, row), 1e-5);
          ASSERT_EQ(painted.source(column, row), expected.source(column, row)) << trial;
        }
      }
    }
  }
  EXPECT_GT(seen_count, 8000 * path_count());
  EXPECT_GT(left_count, 3000 * path_count());
}

}  // namespace
}  // namespace flatpose::rectify
