// What the points of a taught surface stand for.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "flatpose/locate/verify.hpp"
#include "flatpose/teach/teacher.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::teach {
namespace {

using test::MadeScan;
using test::MadeScene;

const Pose kLies = test::pose_at(75.2, 60.4, test::kPartTop_mm, 0.4);
constexpr double kHole_mm = 7.0;

/// A block, or one with a round hole beside its middle.
double top_mm(bool has_hole, double x, double y) {
  const Vec3 p = kLies.inverse() * Vec3{x, y, test::kPartTop_mm};
  const bool in_hole = has_hole && std::hypot(p.x - 10.0, p.y) < kHole_mm;
  return in_hole ? 0.0 : test::bin_height({{kLies}}, x, y);
}

model::Template taught_block(bool has_hole) {
  const MadeScan scan(
      150, 120, 1.0, [&](double x, double y) { return top_mm(has_hole, x, y); }, 0.05);
  const test::Taught t = test::taught({{scan.view(), frames_of_scan(true)}});
  EXPECT_EQ(t.status, Status::kOk) << to_string(t.status);
  return t.part;
}

TEST(SurfaceWeights, SumToTheCountOfPoints) {
  for (const bool has_hole : {false, true}) {
    const model::Template part = taught_block(has_hole);
    double sum = 0.0;
    for (const model::SurfacePoint& p : part.surface_points()) {
      EXPECT_GE(p.weight, 0.0F);
      sum += static_cast<double>(p.weight);
    }
    EXPECT_NEAR(sum, part.surface_count, 1e-3 * part.surface_count);
  }
}

/// Share of the block left of a line `at_mm` along it, counted on a fine grid.
double share_before(bool has_hole, double at_mm) {
  int before = 0;
  int all = 0;
  for (double y = -0.5 * test::kPartHeight_mm + 0.05; y < 0.5 * test::kPartHeight_mm; y += 0.1) {
    for (double x = -0.5 * test::kPartWidth_mm + 0.05; x < 0.5 * test::kPartWidth_mm; x += 0.1) {
      if (has_hole && std::hypot(x - 10.0, y) < kHole_mm) continue;
      ++all;
      before += x < at_mm ? 1 : 0;
    }
  }
  return static_cast<double>(before) / all;
}

TEST(SurfaceWeights, MakeTheVisibleShareThatOfTheArea) {
  for (const bool has_hole : {false, true}) {
    const model::Template part = taught_block(has_hole);
    for (const double at_mm : {-17.0, -12.5, -5.0, 0.0, 4.0, 12.5, 17.0}) {
      // Something high covers the block beyond the line.
      const MadeScene made(MadeScan(150, 120, 1.0, [&](double x, double y) {
        const Vec3 p = kLies.inverse() * Vec3{x, y, test::kPartTop_mm};
        return p.x > at_mm ? 40.0 : top_mm(has_hole, x, y);
      }));
      const locate::Verification v =
          locate::Verifier(part).verify(made.fine, {}, part.scan_T_object, {});
      EXPECT_NEAR(v.visible, share_before(has_hole, at_mm), 0.03) << at_mm << " " << has_hole;
    }
  }
}

}  // namespace
}  // namespace flatpose::teach
