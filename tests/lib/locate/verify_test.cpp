// What a pose explains, on maps where each kind of evidence is made by hand.

#include "flatpose/locate/verify.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/lib/locate/made_bin.hpp"

namespace flatpose::locate {
namespace {

using test::Block;
using test::MadeScan;
using test::MadeScene;

const Pose kTruth = test::pose_at(75.2, 60.4, test::kPartTop_mm, 0.35);

Verification verified(const MadeScan& scan, const Pose& pose,
                      const model::Template& part = test::block_part()) {
  const MadeScene made(scan);
  return Verifier(part).verify(made.fine, {}, pose, {});
}

MadeScan scan_of(const test::HeightOf& height_of) { return {150, 120, 1.0, height_of}; }

double lone_block(double x, double y) { return test::bin_height({{kTruth}}, x, y); }

TEST(Verify, ConfirmsAPartInFullSight) {
  const Verification v = verified(scan_of(lone_block), kTruth);
  EXPECT_EQ(v.visible, 1.0);
  EXPECT_GT(v.score, 0.97);
  EXPECT_LE(v.score, 1.0);
  EXPECT_EQ(v.surface.confirmed_count, v.surface.visible_count);
  EXPECT_EQ(v.surface.claimed_count, 0);
}

TEST(Verify, ContradictsWhatIsNotThere) {
  const MadeScan floor = scan_of([](double, double) { return 0.0; });
  const Verification above = verified(floor, kTruth);
  EXPECT_EQ(above.visible, 1.0);
  EXPECT_EQ(above.score, 0.0);
  EXPECT_EQ(above.surface.confirmed_count, 0);
  // On the floor itself the surface fits, but no contour.
  const Verification on = verified(floor, test::pose_at(75, 60, 0.0));
  EXPECT_EQ(on.surface.confirmed_count, on.surface.visible_count);
  EXPECT_EQ(on.contour.confirmed_count, 0);
  EXPECT_EQ(on.score, 0.0);
}

TEST(Verify, ContradictionsCountInFull) {
  // Half of the part is broken off.
  const MadeScan scan = scan_of([](double x, double y) {
    const Vec3 p = kTruth.inverse() * Vec3{x, y, test::kPartTop_mm};
    return p.x > 0.0 ? 0.0 : lone_block(x, y);
  });
  const Verification v = verified(scan, kTruth);
  EXPECT_EQ(v.visible, 1.0);
  EXPECT_LT(v.score, 0.5);
}

TEST(Verify, MissingSurfaceCountsManifold) {
  // A pit in the middle of the surface, away from all of the contour.
  const MadeScan scan = scan_of([](double x, double y) {
    const Vec3 p = kTruth.inverse() * Vec3{x, y, test::kPartTop_mm};
    const bool in_pit = std::fabs(p.x) < 6.0 && std::fabs(p.y) < 4.0;
    return in_pit ? 0.0 : lone_block(x, y);
  });
  const MadeScene made(scan);
  const model::Template part = test::block_part();
  const auto with_weight = [&](double weight) {
    VerifyConfig config;
    config.contradiction_weight = weight;
    return Verifier(part).verify(made.fine, {}, kTruth, config);
  };
  const Verification once = with_weight(1.0);
  const double confirmed =
      static_cast<double>(once.surface.confirmed_count) / once.surface.visible_count;
  EXPECT_GT(confirmed, 0.9);
  EXPECT_LT(confirmed, 0.98);
  const double contour = once.score / confirmed;  // what the contour makes of it
  EXPECT_GT(contour, 0.97);
  for (const double weight : {2.0, 3.0, 6.0}) {
    EXPECT_NEAR(with_weight(weight).score, contour * (1.0 - weight * (1.0 - confirmed)), 1e-9);
  }
  EXPECT_EQ(with_weight(100.0).score, 0.0);
  EXPECT_EQ(VerifyConfig{}.contradiction_weight, 3.0);
}

/// Half of the part's place holds something else, which says nothing about the part.
void expect_half_seen(const Verification& v) {
  EXPECT_GT(v.visible, 0.35);
  EXPECT_LT(v.visible, 0.65);
  EXPECT_GT(v.score, 0.9);
}

TEST(Verify, WhatIsHiddenSaysNothing) {
  expect_half_seen(verified(
      scan_of([](double x, double y) { return x > 75.0 ? 40.0 : lone_block(x, y); }), kTruth));
}

/// The part along the grid, from x = 50 to 100, with something else at its right end.
Verification with_neighbour(double from_mm, double to_mm) {
  const Pose pose = test::pose_at(75.0, 60.0, test::kPartTop_mm);
  return verified(scan_of([&](double x, double y) {
                    if (x > from_mm && x < to_mm) return 40.0;
                    return test::bin_height({{pose}}, x, y);
                  }),
                  pose);
}

TEST(Verify, AContourAgainstAWallSaysNothing) {
  const Verification free = with_neighbour(0.0, 0.0);
  const Verification walled = with_neighbour(100.0, 150.0);
  EXPECT_LT(walled.contour.visible_count, free.contour.visible_count);
  EXPECT_GT(walled.score, 0.97);
}

TEST(Verify, AContourUnderABarSaysNothing) {
  const Verification free = with_neighbour(0.0, 0.0);
  const Verification barred = with_neighbour(92.5, 100.2);
  EXPECT_LT(barred.contour.visible_count, free.contour.visible_count);
  EXPECT_GT(barred.score, 0.97);
}

TEST(Verify, WhatIsMissingSaysNothing) {
  expect_half_seen(verified(
      scan_of([](double x, double y) { return x > 75.0 ? test::kLost : lone_block(x, y); }),
      kTruth));
}

TEST(Verify, WhatLiesOutOfTheFieldSaysNothing) {
  const MadeScan scan(76, 120, 1.0, lone_block);
  expect_half_seen(verified(scan, kTruth));
}

TEST(Verify, ShareVisibleFallsAsMoreIsHidden) {
  double last = 1.1;
  for (const double from_mm : {110.0, 95.0, 85.0, 75.0, 65.0, 55.0, 40.0}) {
    const Verification v = verified(
        scan_of([&](double x, double y) { return x > from_mm ? 40.0 : lone_block(x, y); }), kTruth);
    EXPECT_LE(v.visible, last);
    last = v.visible;
  }
  EXPECT_EQ(last, 0.0);
}

TEST(Verify, NothingSeenScoresNothing) {
  const Verification v = verified(scan_of(lone_block), test::pose_at(1000.0, 1000.0, 10.0));
  EXPECT_EQ(v.visible, 0.0);
  EXPECT_EQ(v.score, 0.0);
}

TEST(Verify, AHoleOfThePartsShapeIsNotThePart) {
  const MadeScan scan =
      scan_of([](double x, double y) { return test::kPartTop_mm - lone_block(x, y); });
  const Pose in_hole{kTruth.rotation, {kTruth.position_mm.x, kTruth.position_mm.y, 0.0}};
  EXPECT_LT(verified(scan, in_hole).score, 0.1);
}

TEST(Verify, ABarWithoutItsEndsScoresMuchLess) {
  // The middle of a longer bar: nearly all of the contour is there but what holds it along.
  const model::Template bar = test::rectangle_part(100.0, 12.0, test::kPartTop_mm);
  const auto bar_scan = [](double length_mm) {
    return MadeScan(200, 60, 1.0, [=](double x, double y) {
      return test::bin_height({{test::pose_at(100, 30, test::kPartTop_mm), length_mm, 12.0}}, x, y);
    });
  };
  const Pose pose = test::pose_at(100, 30, test::kPartTop_mm);
  const Verification whole = verified(bar_scan(100.0), pose, bar);
  const Verification longer = verified(bar_scan(140.0), pose, bar);
  EXPECT_GT(whole.score, 0.95);
  const double count_share =
      static_cast<double>(longer.contour.confirmed_count) / longer.contour.visible_count;
  EXPECT_GT(count_share, 0.85);
  EXPECT_LT(longer.score, 0.6);
}

TEST(Claim, IsSeenAtThePlaceAndNowhereElse) {
  const Pose other = test::pose_at(30.0, 25.0, test::kPartTop_mm, 0.0);
  const MadeScene made(scan_of([&](double x, double y) {
    return test::bin_height({{kTruth}, {other}}, x, y);
  }));
  std::vector<std::uint8_t> cells(150 * 120, 0);
  const ImageView<std::uint8_t> claimed{cells.data(), 150, 120, 150};
  const model::Template part = test::block_part();
  claim(part, made.fine, kTruth, {}, claimed);
  const Verification again = Verifier(part).verify(made.fine, claimed, kTruth, {});
  EXPECT_EQ(again.surface.claimed_count, again.surface.visible_count);
  const Verification elsewhere = Verifier(part).verify(made.fine, claimed, other, {});
  EXPECT_EQ(elsewhere.surface.claimed_count, 0);
  EXPECT_GT(elsewhere.score, 0.95);
  // Cells claimed lie on the part but for the width of a sample.
  int outside_count = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 150; ++x) {
      if (claimed(x, y) != 0 && !test::on_rectangle(kTruth, 60.0, 40.0, x, y)) ++outside_count;
    }
  }
  EXPECT_EQ(outside_count, 0);
}

}  // namespace
}  // namespace flatpose::locate
