#include "flatpose/rectify/paint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/lib/rectify/scan_fixture.hpp"

namespace flatpose::rectify {
namespace {

constexpr double kPlaneTolerance_mm = 1e-3;  // 1/2048 of a cell, on a slope, and float rounding

void paint_ok(const Scan& scan, const Pose& work_T_scan, const PaintConfig& config, Map& map) {
  Scratch scratch(paint_required_bytes(scan.width_px));
  ASSERT_EQ(paint(scan.view(), work_T_scan, config, scratch.arena, map.map), Status::kOk);
  ASSERT_EQ(scratch.arena.used_bytes(), 0U);
}

/// Scan with columns along x and rows along y, `pitch_mm` apart.
Scan flat_scan(int width, int height, double pitch_mm,
               const std::function<double(double, double)>& z, const Pose& scan_T_work = {}) {
  return Scan(width, height, scan_T_work, [&](int c, int r) {
    return Vec3{c * pitch_mm, r * pitch_mm, z(c * pitch_mm, r * pitch_mm)};
  });
}

TEST(Paint, IsExactOnTiltedPlanesUnderAnyPoseAndHasNoCracks) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 60; ++trial) {
    // A patch of a plane, sampled on a grid that is turned, mirrored and uneven, seen by a sensor
    // in any pose.
    const Pose scan_T_work = trial % 3 == 0 ? looking_down(40.0) : random_pose(random, 3.0);
    const double pitch_mm = uniform(random, 0.2, 3.0);
    const double mirror = random() % 2 == 0 ? 1.0 : -1.0;
    const Rotation turn = rotation_about_z(uniform(random, -3, 3));
    const double gx = uniform(random, -1, 1), gy = uniform(random, -1, 1);
    const Scan scan(24, 20, scan_T_work, [&](int c, int r) {
      Vec3 p = turn * Vec3{mirror * (c - 12 + uniform(random, -0.2, 0.2)) * pitch_mm,
                           (r - 10 + uniform(random, -0.2, 0.2)) * pitch_mm, 0.0};
      p.z = 5.0 + gx * p.x + gy * p.y;
      return p;
    });
    Map map(Grid{uniform(random, -10, -9), uniform(random, -10, -9), uniform(random, 0.4, 1.2), 23,
                 21});
    paint_ok(scan, scan_T_work.inverse(), {.jump_mm = 1, .max_slope = 2, .max_gap_mm = 50}, map);
    for (int row = 0; row < 21; ++row) {
      for (int column = 0; column < 23; ++column) {
        const double x = map.map.grid.x_of(column), y = map.map.grid.y_of(row);
        const Vec3 on_scan = (1.0 / pitch_mm) * (turn.inverse() * Vec3{x, y, 0});
        const double inside =
            std::min(11.5 - std::fabs(mirror * on_scan.x + 0.5), 9.5 - std::fabs(on_scan.y + 0.5));
        if (inside > 0.3) {
          ASSERT_TRUE(map.seen(column, row)) << trial << " " << x << " " << y;
        }
        if (inside < -0.3) {
          ASSERT_FALSE(map.seen(column, row)) << trial;
        }
        if (!map.seen(column, row)) continue;
        ASSERT_NEAR(map.height_mm(column, row), 5.0 + gx * x + gy * y, kPlaneTolerance_mm);
        const int source = map.source(column, row);
        const Vec3 p = scan_T_work.inverse() * scan.view()(source % 24, source / 24);
        ASSERT_LT(std::max(std::fabs(p.x - x), std::fabs(p.y - y)), 1.4 * pitch_mm);
      }
    }
  }
}

TEST(Paint, DoesNotBridgeJumpsButClimbsSlopes) {
  for (const bool along_rows : {true, false}) {
    const Scan scan = flat_scan(
        20, 20, 1.0, [&](double x, double y) { return (along_rows ? y : x) < 9.5 ? 0.0 : 3.0; });
    Map map(Grid{0.25, 0.25, 0.5, 37, 37});
    paint_ok(scan, {}, {.jump_mm = 1, .max_slope = 1.9, .max_gap_mm = 5}, map);
    for (int row = 0; row < 37; ++row) {
      for (int column = 0; column < 37; ++column) {
        const double across_mm = 0.25 + 0.5 * (along_rows ? row : column);
        if (across_mm > 9.0 && across_mm < 10.0) {
          EXPECT_FALSE(map.seen(column, row));
          EXPECT_EQ(map.source(column, row), kNoSource);
        } else {
          EXPECT_EQ(map.height_mm(column, row), across_mm < 9.5 ? 0.0F : 3.0F);
        }
      }
    }
    paint_ok(scan, {}, {.jump_mm = 1, .max_slope = 2.1, .max_gap_mm = 5}, map);
    EXPECT_EQ(map.seen_count(), 37 * 37);
  }
}

TEST(Paint, DoesNotBridgeGaps) {
  const Scan scan(20, 4, {}, [](int c, int r) {
    return Vec3{c + (c >= 10 ? 6.0 : 0.0), static_cast<double>(r), 0.0};
  });
  Map map(Grid{0.5, 0.5, 1.0, 24, 3});
  paint_ok(scan, {}, {.max_gap_mm = 6.9}, map);
  EXPECT_EQ(map.seen_count(), 3 * (24 - 7 + 1) - 3);
  EXPECT_FALSE(map.seen(9, 1));
  EXPECT_TRUE(map.seen(16, 1));
  paint_ok(scan, {}, {.max_gap_mm = 7.2}, map);
  EXPECT_EQ(map.seen_count(), 3 * 24);
}

TEST(Paint, KeepsTheTriangleLeftByALostCorner) {
  // One quad of 8 cells a side; each corner lost in turn leaves the half that has the other three.
  for (int lost = 0; lost < 4; ++lost) {
    Scan scan = flat_scan(2, 2, 8.0, [](double x, double y) { return 0.1 * x + 0.2 * y; });
    scan.lose(lost % 2, lost / 2);
    Map map(Grid{0.5, 0.5, 1.0, 8, 8});
    paint_ok(scan, {}, {.max_gap_mm = 20}, map);
    const Vec3 lost_mm{8.0 * (lost % 2), 8.0 * (lost / 2), 0};
    for (int row = 0; row < 8; ++row) {
      for (int column = 0; column < 8; ++column) {
        const double x = 0.5 + column, y = 0.5 + row;
        const double away = std::fabs(x - lost_mm.x) + std::fabs(y - lost_mm.y) - 8.0;
        if (std::fabs(away) < 0.1) continue;  // on the diagonal
        ASSERT_EQ(map.seen(column, row), away > 0.0) << lost << " " << x << " " << y;
        if (away > 0.0) {
          EXPECT_NEAR(map.height_mm(column, row), 0.1 * x + 0.2 * y, 1e-3);
        }
      }
    }
  }
}

TEST(Paint, CutsCornersAlikeInEveryDirection) {
  // One corner stands out instead of missing: the other three still make their triangle.
  for (int high = 0; high < 4; ++high) {
    Scan scan = flat_scan(2, 2, 8.0, [](double, double) { return 0.0; });
    scan.set(high % 2, high / 2, {8.0 * (high % 2), 8.0 * (high / 2), 50.0});
    Map map(Grid{0.6, 0.4, 1.0, 8, 8});
    paint_ok(scan, {}, {.max_slope = 1.0, .max_gap_mm = 20}, map);
    EXPECT_NEAR(map.seen_count(), 32, 4);
    EXPECT_TRUE(std::all_of(map.heights_mm.begin(), map.heights_mm.end(),
                            [](float z) { return std::isnan(z) || z == 0.0F; }));
  }
}

TEST(Paint, LetsTheHighestWin) {
  // The scan folds back under itself: columns run out and return 4 mm lower, or higher.
  for (const double back_mm : {-4.0, 4.0}) {
    const Scan scan(40, 10, {}, [&](int c, int r) {
      return c < 20 ? Vec3{1.0 * c, 1.0 * r, 0.0} : Vec3{39.0 - c, 1.0 * r, back_mm};
    });
    Map map(Grid{0.5, 0.5, 1.0, 19, 9});
    paint_ok(scan, {}, {}, map);
    for (const float z : map.heights_mm) EXPECT_EQ(z, std::max(0.0F, static_cast<float>(back_mm)));
    for (const int source : map.sources) EXPECT_EQ(source % 40 >= 20, back_mm > 0);
  }
}

// ---- an oracle without boxes, increments or tables ----

struct OraclePoint {
  bool valid;
  double u, v;  // cells, as snapped
  double z_mm;
};

std::vector<OraclePoint> oracle_points(const Scan& scan, const Pose& work_T_scan,
                                       const Grid& grid) {
  std::vector<OraclePoint> points;
  for (int i = 0; i < scan.width_px * scan.height_px; ++i) {
    const Vec3 p = work_T_scan * scan.view()(i % scan.width_px, i / scan.width_px);
    const auto snap = [](double cells) { return (std::floor(cells * 2048.0) + 0.5) / 2048.0; };
    points.push_back({is_valid(p), snap(grid.column_of(p.x)), snap(grid.row_of(p.y)),
                      static_cast<double>(static_cast<float>(p.z))});
  }
  return points;
}

class Oracle {
 public:
  Oracle(const Scan& scan, const Pose& work_T_scan, const PaintConfig& config, const Grid& grid)
      : config_(config), grid_(grid), points_(oracle_points(scan, work_T_scan, grid)) {
    for (int r = 0; r + 1 < scan.height_px; ++r) {
      for (int c = 0; c + 1 < scan.width_px; ++c) {
        const int a = r * scan.width_px + c, b = a + 1, d = a + scan.width_px, e = d + 1;
        const bool first[] = {hold(a, b, e), hold(a, e, d)};
        const bool second[] = {hold(a, b, d), hold(b, e, d)};
        if (second[0] + second[1] > first[0] + first[1]) {
          if (second[0]) triangles_.push_back({a, b, d});
          if (second[1]) triangles_.push_back({b, e, d});
        } else {
          if (first[0]) triangles_.push_back({a, b, e});
          if (first[1]) triangles_.push_back({a, e, d});
        }
      }
    }
  }

  /// Height of the highest triangle over a cell, NaN without one; `nearest` the corners of that
  /// height that are nearest.
  double height_mm(int column, int row, std::vector<int>& nearest) const {
    double best_mm = std::nan("");
    for (const auto& t : triangles_) {
      const OraclePoint& a = points_[t[0]];
      const OraclePoint& b = points_[t[1]];
      const OraclePoint& c = points_[t[2]];
      const auto cross = [&](const OraclePoint& p, const OraclePoint& q) {
        return (p.u - column) * (q.v - row) - (p.v - row) * (q.u - column);
      };
      const double wa = cross(b, c), wb = cross(c, a), wc = cross(a, b);
      const double area = wa + wb + wc;
      if (area == 0.0 || wa * area < 0 || wb * area < 0 || wc * area < 0) continue;
      const double z_mm = (wa * a.z_mm + wb * b.z_mm + wc * c.z_mm) / area;
      if (z_mm < best_mm - 1e-5) continue;
      if (!(z_mm <= best_mm + 1e-5)) nearest.clear();
      best_mm = std::fmax(best_mm, z_mm);
      const int* const corner = std::min_element(t.begin(), t.end(), [&](int i, int j) {
        return distance(i, column, row) < distance(j, column, row);
      });
      for (const int i : t)
        if (distance(i, column, row) < distance(*corner, column, row) + 1e-6) nearest.push_back(i);
    }
    return best_mm;
  }

 private:
  [[nodiscard]] double distance(int i, int column, int row) const {
    return std::hypot(points_[i].u - column, points_[i].v - row);
  }
  [[nodiscard]] bool hold(int a, int b) const {
    if (!points_[a].valid || !points_[b].valid) return false;
    const double length_mm =
        grid_.cell_mm * std::hypot(points_[a].u - points_[b].u, points_[a].v - points_[b].v);
    const double step_mm = std::fabs(points_[a].z_mm - points_[b].z_mm);
    return length_mm <= config_.max_gap_mm &&
           step_mm <= config_.jump_mm + config_.max_slope * length_mm;
  }
  [[nodiscard]] bool hold(int a, int b, int c) const {
    return hold(a, b) && hold(b, c) && hold(c, a);
  }

  PaintConfig config_;
  Grid grid_;
  std::vector<OraclePoint> points_;
  std::vector<std::array<int, 3>> triangles_;
};

TEST(Paint, EqualsTheOracleOnRandomScans) {
  std::mt19937 random(7);
  int seen_count = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    // Coarse to fine, tidy to folded over itself, now and then on exact fractions of a cell.
    const double pitch_mm = uniform(random, 0.1, 4.0);
    const double mess = random() % 2 == 0 ? 0.1 : uniform(random, 0, 2);
    const double lost = uniform(random, 0, 0.3), rough_mm = uniform(random, 0, 4);
    const bool on_lattice = random() % 4 == 0;
    const Pose scan_T_work = random() % 2 == 0 ? looking_down(40.0) : random_pose(random, 3.0);
    const int width = 2 + static_cast<int>(random() % 9),
              height = 2 + static_cast<int>(random() % 6);
    Scan scan(width, height, on_lattice ? Pose{} : scan_T_work, [&](int c, int r) {
      Vec3 p{(c + uniform(random, -mess, mess)) * pitch_mm,
             (r + uniform(random, -mess, mess)) * pitch_mm, uniform(random, 0, rough_mm)};
      if (on_lattice) p = {std::floor(2 * p.x) / 2, std::floor(2 * p.y) / 2, p.z};
      if (uniform(random, 0, 1) < lost) p.z = std::nan("");
      return p;
    });
    const Pose work_T_scan = on_lattice ? Pose{} : scan_T_work.inverse();
    const PaintConfig config{uniform(random, 0, 3), uniform(random, 0, 2), uniform(random, 1, 9)};
    Map map(on_lattice ? Grid{-0.5, 0.5, 1.0, 12, 10}
                       : Grid{0.1, -0.3, uniform(random, 0.3, 2), 12, 10});
    paint_ok(scan, work_T_scan, config, map);
    const Oracle oracle(scan, work_T_scan, config, map.map.grid);
    for (int row = 0; row < 10; ++row) {
      for (int column = 0; column < 12; ++column) {
        std::vector<int> nearest;
        const double expected_mm = oracle.height_mm(column, row, nearest);
        ASSERT_EQ(map.seen(column, row), !std::isnan(expected_mm)) << trial;
        if (!map.seen(column, row)) continue;
        ++seen_count;
        ASSERT_NEAR(map.height_mm(column, row), expected_mm, 1e-5) << trial;
        ASSERT_TRUE(std::count(nearest.begin(), nearest.end(), map.source(column, row))) << trial;
      }
    }
  }
  EXPECT_GT(seen_count, 20000);
}

TEST(Paint, HasNoHolesInsideRandomMeshes) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const double pitch_mm = uniform(random, 0.15, 5.0);
    const Pose turn{rotation_about_z(uniform(random, -3, 3)), {0, 0, 0}};
    const Scan scan(20, 20, turn, [&](int c, int r) {
      return pitch_mm * Vec3{c - 10 + uniform(random, -0.45, 0.45),
                             r - 10 + uniform(random, -0.45, 0.45), uniform(random, 0, 9)};
    });
    Map map(Grid{-12, -12, 1.0, 25, 25});
    paint_ok(scan, {}, {.jump_mm = 1e6, .max_gap_mm = 1e6}, map);
    for (int row = 0; row < 25; ++row) {
      for (int column = 0; column < 25; ++column) {
        if (std::hypot(column - 12, row - 12) < 8.4 * pitch_mm) {
          ASSERT_TRUE(map.seen(column, row)) << trial;
        }
      }
    }
  }
}

TEST(Paint, ReadsStridedViewsAlike) {
  std::mt19937 random(5);
  const Scan scan = flat_scan(9, 7, 1.1, [&](double, double) { return uniform(random, 0, 1); });
  Map expected(Grid{0.5, 0.5, 1.0, 9, 7});
  paint_ok(scan, {}, {}, expected);
  for (const int stride : {1, 3, 4, 5, 8}) {
    const int row_floats = 9 * stride + 3;
    std::vector<float> padded(static_cast<std::size_t>(3 * 7 * row_floats), kNan);
    const bool planes = stride < 3;
    const int plane = planes ? 7 * row_floats : 1;
    for (int i = 0; i < 9 * 7; ++i) {
      for (int k = 0; k < 3; ++k)
        padded[i / 9 * row_floats + i % 9 * stride + k * plane] = scan.xyz_mm[3 * i + k];
    }
    const float* const p = padded.data();
    const RangeImageView view{p, p + plane, p + 2 * plane, 9, 7, 4 * stride, 4 * row_floats};
    Map map(expected.map.grid);
    Scratch scratch(paint_required_bytes(9));
    ASSERT_EQ(paint(view, {}, {}, scratch.arena, map.map), Status::kOk);
    EXPECT_EQ(map.sources, expected.sources) << stride;
  }
}

TEST(Paint, ClipsToTheGridAndLeavesItEmptyFarAway) {
  const Scan scan = flat_scan(50, 50, 1.0, [](double x, double) { return x; });
  Map inside(Grid{20.2, 20.2, 1.0, 5, 4});
  paint_ok(scan, {}, {}, inside);
  EXPECT_EQ(inside.seen_count(), 20);
  EXPECT_NEAR(inside.height_mm(4, 3), 24.2, 1e-3);
  for (const double shift_mm : {60.0, -60.0, 1e5, -1e5, 1e9, -1e9}) {
    for (const bool in_x : {true, false}) {
      Map outside(Grid{in_x ? shift_mm : 0.0, in_x ? 0.0 : shift_mm, 1.0, 5, 4});
      paint_ok(scan, {}, {.max_gap_mm = 1e6}, outside);
      EXPECT_EQ(outside.seen_count(), 0);
    }
  }
  // One quad far larger than the grid, and than any grid may be.
  const Scan huge = flat_scan(2, 2, 40000.0, [](double x, double) { return 1e-3 * x; });
  Map part(Grid{20000, 20000, 1.0, 7, 7});
  paint_ok(huge, {}, {.max_gap_mm = 1e6}, part);
  EXPECT_EQ(part.seen_count(), 49);
  EXPECT_NEAR(part.height_mm(6, 6), 20.006, 1e-3);
}

TEST(Paint, TakesScansWithoutAQuadAsEmpty) {
  for (const auto& [width, height] : {std::pair{1, 9}, {9, 1}, {1, 1}, {0, 0}, {0, 5}}) {
    const Scan scan = flat_scan(width, height, 1.0, [](double, double) { return 0.0; });
    Map map(Grid{0, 0, 1.0, 9, 9});
    paint_ok(scan, {}, {}, map);
    EXPECT_EQ(map.seen_count(), 0);
    EXPECT_EQ(map.source(0, 0), kNoSource);
  }
}

TEST(Paint, TakesNonFinitePointsAsMissing) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {kNan, infinity, -infinity, 3e38F}) {
    for (int k = 0; k < 3; ++k) {
      Scan scan = flat_scan(3, 3, 1.0, [](double, double) { return 0.0; });
      scan.xyz_mm[3 * 4 + k] = bad;
      Map map(Grid{0.3, 0.3, 0.1, 15, 15});
      paint_ok(scan, looking_down(1.0), {.jump_mm = 1e6, .max_gap_mm = 1e6}, map);
      for (const float z : map.heights_mm) EXPECT_TRUE(std::isnan(z) || z == 1.0F);
    }
  }
}

TEST(Paint, RefusesWhatItCannotUse) {
  const Scan scan = flat_scan(8, 8, 1.0, [](double, double) { return 0.0; });
  const auto status = [&](auto change) {
    RangeImageView view = scan.view();
    Pose pose;
    PaintConfig config;
    Map map(Grid{0, 0, 1.0, 8, 8});
    std::size_t size_bytes = paint_required_bytes(8);
    change(view, pose, config, map.map, size_bytes);
    Scratch scratch(size_bytes);
    const Status result = paint(view, pose, config, scratch.arena, map.map);
    if (result != Status::kOk) {
      EXPECT_EQ(map.height_mm(3, 3), 777.0F) << "not left as it was";
    }
    return result;
  };
  using V = RangeImageView;
  using C = PaintConfig;
  using H = HeightMap;
  EXPECT_EQ(status([](V&, Pose&, C&, H&, std::size_t&) {}), Status::kOk);
  EXPECT_EQ(status([](V&, Pose&, C&, H&, std::size_t& b) { b -= 100; }), Status::kOutOfMemory);
  EXPECT_EQ(status([](V&, Pose& p, C&, H&, std::size_t&) { p.position_mm.x = std::nan(""); }),
            Status::kNotFinite);
  EXPECT_EQ(status([](V&, Pose&, C& c, H&, std::size_t&) { c.jump_mm = -1; }),
            Status::kInvalidArgument);
  EXPECT_EQ(status([](V&, Pose&, C& c, H&, std::size_t&) { c.max_slope = std::nan(""); }),
            Status::kInvalidArgument);
  EXPECT_EQ(status([](V&, Pose&, C& c, H&, std::size_t&) { c.max_gap_mm = 0; }),
            Status::kInvalidArgument);
  EXPECT_EQ(status([](V& v, Pose&, C&, H&, std::size_t&) { v.pixel_stride_bytes = 13; }),
            Status::kInvalidArgument);
  EXPECT_EQ(status([](V& v, Pose&, C&, H&, std::size_t&) { v.x_mm = nullptr; }),
            Status::kInvalidArgument);
  EXPECT_EQ(status([](V&, Pose&, C&, H& h, std::size_t&) { h.grid.cell_mm = 0; }),
            Status::kInvalidArgument);
  EXPECT_EQ(status([](V&, Pose&, C&, H& h, std::size_t&) { h.grid.width_px = 9; }),
            Status::kShapeMismatch);
  EXPECT_EQ(status([](V&, Pose&, C&, H& h, std::size_t&) { h.grid.width_px = 40000; }),
            Status::kTooLarge);
  EXPECT_EQ(status([](V& v, Pose&, C&, H&, std::size_t&) { v.width_px = 70000; }),
            Status::kTooLarge);
}

}  // namespace
}  // namespace flatpose::rectify
