#include "port/sim/rim.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flatpose::sim {
namespace {

TEST(Rims, HoldEveryCornerAndNoGapOfMoreThanAStep) {
  for (const std::string& name : part_names()) {
    const Part part = catalogue_part(name);
    const Rims found = rims(part);
    std::vector<Loop> loops{part.outline.outer};
    loops.insert(loops.end(), part.outline.holes.begin(), part.outline.holes.end());
    for (const Loop& loop : loops) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 middle = 0.5 * (loop[i] + loop[(i + 1) % loop.size()]);
        for (const auto* rim : {&found.top_mm, &found.bottom_mm}) {
          double nearest_mm = 1e9;
          for (const Vec3& p : *rim) {
            nearest_mm = std::min(nearest_mm, std::hypot(p.x - middle.x, p.y - middle.y));
          }
          EXPECT_LE(nearest_mm, 0.5 * kRimStepMm + kChordErrorMm) << name;
        }
      }
    }
    for (const Vec3& p : found.bottom_mm) EXPECT_EQ(p.z, -part.thickness_mm);
  }
}

TEST(Rims, TakeTheHigherSideOfAStep) {
  Part part{.name = "x", .outline = {}, .thickness_mm = 9.0, .areas = {}};
  part.outline.outer = rectangle({}, 100, 100);
  part.areas = {{rectangle({-20, 0}, 10, 10), 4.0}, {rectangle({20, 0}, 10, 10), -6.0}};
  for (const Vec3& p : rims(make_part(part)).top_mm) {
    const bool raised = std::fabs(p.x + 20) < 6 && std::fabs(p.y) < 6;
    EXPECT_EQ(p.z, raised ? 4.0 : 0.0) << p.x << " " << p.y;
  }
}

TEST(CenterOfMass, IsTheMiddleOfAPlainPart) {
  for (const std::string name : {"pad", "washer", "cylinder"}) {
    const Part part = catalogue_part(name);
    EXPECT_LT(norm(center_of_mass_mm(part) - Vec3{0, 0, -0.5 * part.thickness_mm}), 1e-9);
  }
}

TEST(CenterOfMass, CountsAreas) {
  // A slab of 100 x 100 x 10 with a block of 20 x 20 x 30 on it at (30, 0).
  Part part{.name = "x", .outline = {}, .thickness_mm = 10.0, .areas = {}};
  part.outline.outer = rectangle({}, 100, 100);
  part.areas = {{rectangle({30, 0}, 20, 20), 30.0}};
  const Vec3 center = center_of_mass_mm(make_part(part));
  EXPECT_NEAR(center.x, 30.0 * 12.0 / 112.0, 1e-9);
  EXPECT_NEAR(center.y, 0.0, 1e-9);
  EXPECT_NEAR(center.z, (-5.0 * 100.0 + 15.0 * 12.0) / 112.0, 1e-9);
}

}  // namespace
}  // namespace flatpose::sim
