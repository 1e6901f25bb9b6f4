// Parts that touch, parts that are nearly symmetric, and parts of which the best place to look at
// is covered.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::locate {
namespace {

using test::Block;
using test::Locating;
using test::MadeScan;

constexpr double kSide_mm = 40.0;

model::Template square_part() {
  model::Template part = test::rectangle_part(kSide_mm, kSide_mm, test::kPartTop_mm);
  part.symmetry.order = 4;
  return part;
}

Block square_at(double x_mm, double y_mm) {
  return {test::pose_at(x_mm, y_mm, test::kPartTop_mm), kSide_mm, kSide_mm};
}

LocateResult found_squares(const std::vector<Block>& blocks, double min_score = -1.0) {
  Locating locating;
  LocateConfig config;
  config.max_matches = 10;
  config.min_score = min_score;
  EXPECT_EQ(locating.run(square_part(), test::bin_scan(blocks, 0.05, 200, 150).view(), config),
            Status::kOk);
  return locating.result;
}

/// The score of the match on a square; -1 where there is none.
double score_on(const LocateResult& result, const Block& square) {
  for (const Match& m : result.found()) {
    const test::PoseError e = test::pose_error(m.face_T_object, square.scan_T_object);
    if (e.in_plane_mm < 1.0 && e.z_mm < 0.3 && e.tilt_deg < 1.0) return m.score;
  }
  return -1.0;
}

TEST(Crowd, AMatchExplainsWhyTheContourBesideItIsNotSeen) {
  // Where the two touch there is no edge. The first to be taken lacks a side, the other does not.
  const std::vector<Block> squares{square_at(50.2, 60.3), square_at(90.2, 60.3)};
  const LocateResult r = found_squares(squares, 0.6);
  ASSERT_EQ(r.match_count, 2);
  const double a = score_on(r, squares[0]);
  const double b = score_on(r, squares[1]);
  EXPECT_GT(std::max(a, b), 0.95);
  EXPECT_GT(std::min(a, b), 0.65);
  EXPECT_LT(std::min(a, b), 0.85);
}

TEST(Crowd, APartBetweenTwoIsFoundByTheirLeave) {
  // The one between lacks half of two sides and is no match until its neighbours are.
  const std::vector<Block> squares{square_at(40.2, 50.3), square_at(80.2, 70.3),
                                   square_at(120.2, 50.3)};
  const LocateResult r = found_squares(squares);
  ASSERT_EQ(r.match_count, 3);
  for (const Block& square : squares) EXPECT_GT(score_on(r, square), 0.8);
}

TEST(Crowd, APartIsLookedAtAgainWhenItsNeighboursAreFound) {
  // Four touch the one between on four tenths of a side each; bars hide so much of them that they
  // are considered after it.
  const Block between = square_at(100.2, 75.3);
  const std::vector<Block> around{square_at(60.2, 99.3), square_at(124.2, 115.3),
                                  square_at(140.2, 51.3), square_at(76.2, 35.3)};
  std::vector<Block> all = around;
  all.push_back(between);
  for (const auto& [x, y] : {std::pair{46.2, 99.3}, {154.2, 51.3}})
    all.push_back({test::pose_at(x, y, 40.0), 12.0, 50.0});
  for (const auto& [x, y] : {std::pair{124.2, 129.3}, {76.2, 21.3}})
    all.push_back({test::pose_at(x, y, 40.0), 50.0, 12.0});
  const LocateResult r = found_squares(all);
  EXPECT_EQ(r.match_count, 5);
  EXPECT_GT(score_on(r, between), 0.8);
  for (const Block& square : around) EXPECT_GT(score_on(r, square), 0.8);
}

TEST(Crowd, WhatTwoPartsTogetherLookLikeIsNotFound) {
  // Between two that touch lies a third place with two sides and both ends astray.
  const std::vector<Block> squares{square_at(50.2, 60.3), square_at(90.2, 60.3)};
  const LocateResult r = found_squares(squares, 0.4);
  EXPECT_EQ(score_on(r, square_at(70.2, 60.3)), -1.0);
  EXPECT_EQ(r.match_count, 2);
}

/// A trapezium: half a turn lays it onto itself but for a little over a millimetre.
struct Trapezium {
  static constexpr double kLength_mm = 60.0;
  static constexpr double kNarrow_mm = 28.0;
  static constexpr double kWide_mm = 30.8;

  static double half_width_at(double x) {
    return 0.25 * (kNarrow_mm + kWide_mm) + 0.5 * (kWide_mm - kNarrow_mm) * x / kLength_mm;
  }
  static MadeScan scan(const Pose& pose, double noise_mm, unsigned seed) {
    return {150,
            120,
            1.0,
            [&](double x, double y) {
              const Vec3 p = pose.inverse() * Vec3{x, y, test::kPartTop_mm};
              const bool on =
                  std::fabs(p.x) < 0.5 * kLength_mm && std::fabs(p.y) < half_width_at(p.x);
              return on ? test::kPartTop_mm : 0.0;
            },
            noise_mm,
            seed};
  }
  static model::Template part() {
    model::Template part = test::rectangle_part(kLength_mm, 30.0, test::kPartTop_mm);
    const double slope = 0.5 * (kWide_mm - kNarrow_mm) / kLength_mm;
    for (model::ContourPoint& c : part.contour) {
      if (c.ny == 0.0F) {
        c.y_mm *= static_cast<float>(half_width_at(static_cast<double>(c.x_mm)) / 15.0);
        continue;
      }
      c.y_mm = static_cast<float>(half_width_at(static_cast<double>(c.x_mm))) * c.ny;
      c.nx = static_cast<float>(-slope / std::sqrt(1.0 + slope * slope));
      c.ny *= static_cast<float>(1.0 / std::sqrt(1.0 + slope * slope));
    }
    return part;
  }
};

TEST(Crowd, OfTwoPosesInOnePlaceTheBetterOnRawPointsIsTaken) {
  int right_count = 0;
  constexpr int kCount = 12;
  for (unsigned i = 0; i < kCount; ++i) {
    const Pose pose = test::pose_at(74.0 + 0.2 * i, 60.5, test::kPartTop_mm, 0.53 * i);
    Locating locating;
    ASSERT_EQ(locating.run(Trapezium::part(), Trapezium::scan(pose, 0.1, i).view()), Status::kOk);
    ASSERT_EQ(locating.result.match_count, 1) << i;
    const test::PoseError e = test::pose_error(locating.result.matches[0].face_T_object, pose);
    EXPECT_LT(e.in_plane_mm, 1.0) << i;
    right_count += e.turn_deg < 5.0 ? 1 : 0;
  }
  EXPECT_EQ(right_count, kCount);
}

TEST(Crowd, ADiscIsFoundFromAnchorsBesideItsCoveredCentre) {
  constexpr double kRadius_mm = 30.0;
  const MadeScan scan(
      150, 120, 1.0,
      [](double x, double y) {
        const double from_centre = std::hypot(x - 70.2, y - 60.7);
        if (from_centre < 8.0) return 25.0;  // a bolt stands on its middle, a bar on one side
        if (x > 78.0 && x < 104.0 && std::fabs(y - 63.0) < 12.0) return 25.0;
        return from_centre <= kRadius_mm ? 10.0 : 0.0;
      },
      0.05);
  model::Template part = test::disc_part(kRadius_mm, 10.0);
  Locating locating;
  ASSERT_EQ(locating.run(part, scan.view()), Status::kOk);
  EXPECT_EQ(locating.result.match_count, 0);  // from the centre alone
  part.anchors[1] = {18.0F, 3.0F, 10.0F};
  part.anchor_count = 2;
  ASSERT_EQ(locating.run(part, scan.view()), Status::kOk);
  ASSERT_EQ(locating.result.match_count, 1);
  const Vec3& at_mm = locating.result.matches[0].face_T_object.position_mm;
  EXPECT_NEAR(at_mm.x, 70.2, 0.3);
  EXPECT_NEAR(at_mm.y, 60.7, 0.3);
}

}  // namespace
}  // namespace flatpose::locate
