// The points under a part, and their sums on every vector path.

#include "flatpose/refine/footprint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <random>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/refine/normal_equations.hpp"
#include "flatpose/refine/surface_sums.hpp"
#include "tests/lib/locate/made_scan.hpp"
#include "tests/lib/search/vector_paths.hpp"

namespace flatpose::refine {
namespace {

constexpr double kTop_mm = 10.0;
const Pose kTruth = test::pose_at(45.3, 40.8, kTop_mm, 17.0 * kRadPerDeg);

struct Held {
  std::vector<std::byte> memory = std::vector<std::byte>(1'000'000);
  Arena arena{std::span(memory)};
  Footprint footprint = take_footprint(arena);
};

test::MadeScan sloping_scan() {
  return {90, 80, 1.0, [](double x, double y) {
            return test::on_rectangle(kTruth, 50.0, 30.0, x, y) ? kTop_mm + 0.01 * x : 0.0;
          }};
}

TEST(Footprint, HoldsThePointsUnderThePart) {
  const test::MadeScan scan = sloping_scan();
  const test::MadeScene made(scan);
  const RawScan raw{scan.view(), {}, &made.scene.map};
  const model::Template part = test::rectangle_part(50.0, 30.0, kTop_mm);
  Held all;
  gather(part, raw, kTruth, false, all.footprint);
  EXPECT_NEAR(all.footprint.count, 50 * 30, 0.3 * 50 * 30);
  for (int i = 0; i < all.footprint.count; ++i) {
    const Vec3 at_mm = kTruth * Vec3{all.footprint.x_mm[i], all.footprint.y_mm[i], 0.0};
    ASSERT_LT(std::fabs(all.footprint.x_mm[i]), 30.0F);
    ASSERT_LT(std::fabs(all.footprint.y_mm[i]), 20.0F);
    if (test::on_rectangle(kTruth, 50.0, 30.0, at_mm.x, at_mm.y)) {
      ASSERT_NEAR(all.footprint.above_mm[i], 0.01 * at_mm.x, 1e-4);
    }
  }
  Held thinned;
  gather(part, raw, kTruth, true, thinned.footprint);
  EXPECT_NEAR(thinned.footprint.count, 0.25 * all.footprint.count, 0.05 * all.footprint.count);
}

TEST(Footprint, OfNothingIsEmpty) {
  const test::MadeScan scan = sloping_scan();
  const test::MadeScene made(scan);
  const RawScan raw{scan.view(), {}, &made.scene.map};
  Held held;
  gather(test::rectangle_part(50.0, 30.0, kTop_mm), raw, test::pose_at(500, 500, kTop_mm), false,
         held.footprint);
  EXPECT_EQ(held.footprint.count, 0);
}

// A footprint of any points, of a count that fills no vector.
void fill(Footprint& footprint, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> above(-2.0F, 2.0F), across(-80.0F, 80.0F);
  footprint.count = count;
  for (int i = 0; i < count || i % Footprint::kLaneCount != 0; ++i) {
    footprint.above_mm[i] = i < count ? above(random) : 1e15F;
    footprint.x_mm[i] = across(random);
    footprint.y_mm[i] = across(random);
  }
}

TEST(SurfaceSums, AreThoseOfTukeysLossPointByPoint) {
  const SurfaceStep step{0.003, -0.002, 0.1};
  const double scale_mm = 1.3;
  for (const int count : {0, 1, 7, 8, 9, 1000}) {
    Held held;
    fill(held.footprint, count, 5);
    NormalEquations<3> slow;
    for (int i = 0; i < count; ++i) {
      const double x = held.footprint.x_mm[i];
      const double y = held.footprint.y_mm[i];
      const double r = held.footprint.above_mm[i] - (y * step.turn_x_rad - x * step.turn_y_rad) -
                       step.shift_z_mm;
      slow.add(r, {-y, x, -1.0}, 1.0, RobustLoss::tukey(scale_mm));
    }
    SurfaceSums s;
    sum_surface_for(VectorPath::kPortable)(held.footprint, step, scale_mm, s);
    const auto expect_equal = [&](double is, double should_be) {
      EXPECT_NEAR(is, should_be, 1e-9 * (1.0 + std::fabs(should_be))) << count;
    };
    expect_equal(scale_mm * scale_mm / 6.0 * (count - s.u3), slow.cost());
    expect_equal(s.wrr, slow.square_sum());
    expect_equal(s.w, slow.weight_sum());
    expect_equal(-s.wry, slow.gradient()[0]);
    expect_equal(s.wrx, slow.gradient()[1]);
    expect_equal(-s.wr, slow.gradient()[2]);
    expect_equal(s.wyy, slow.hessian(0, 0));
    expect_equal(-s.wxy, slow.hessian(1, 0));
    expect_equal(s.wxx, slow.hessian(1, 1));
    expect_equal(s.wy, slow.hessian(2, 0));
    expect_equal(-s.wx, slow.hessian(2, 1));
    expect_equal(s.w, slow.hessian(2, 2));
  }
}

TEST(SurfaceSums, HaveTheSameBitsOnEveryPath) {
  for (const int count : {3, 64, 997}) {
    Held held;
    fill(held.footprint, count, 7);
    SurfaceSums portable;
    sum_surface_for(VectorPath::kPortable)(held.footprint, {0.001, 0.002, 0.3}, 1.0, portable);
    for (const VectorPath path : vector_paths()) {
      SurfaceSums sums;
      sum_surface_for(path)(held.footprint, {0.001, 0.002, 0.3}, 1.0, sums);
      EXPECT_EQ(std::memcmp(&sums, &portable, sizeof sums), 0) << static_cast<int>(path);
    }
  }
}

}  // namespace
}  // namespace flatpose::refine
