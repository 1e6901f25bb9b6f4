#include "port/sim/part.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose::sim {
namespace {

Vec2 turned(Vec2 p, double angle_rad) {
  const auto [s, c] = sin_cos(angle_rad);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

/// Intersection over union of the part with itself moved, on a grid off the axes; where both are
/// but differ in height, by an area, they do not agree.
template <class Move>
double overlap(const Part& part, Move move) {
  int both = 0, any = 0;
  for (double y = -89.63; y < 90; y += 2.7) {
    const TopRow row(part, y);
    for (double x = -89.41; x < 90; x += 2.7) {
      const auto a = row.height_mm(x);
      const auto b = top_height_mm(part, move(Vec2{x, y}));
      both += a && a == b;
      any += a || b;
    }
  }
  return static_cast<double>(both) / any;
}

TEST(Catalogue, HoldsTheNinePartsAndNamesThemInTheError) {
  EXPECT_EQ(part_names().size(), 9u);
  for (const std::string& name : part_names()) EXPECT_EQ(catalogue_part(name).name, name);
  try {
    (void)catalogue_part("spoon");
    FAIL();
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("spoon"), std::string::npos);
    for (const std::string& name : part_names()) EXPECT_NE(text.find(name), std::string::npos);
  }
}

TEST(Catalogue, OriginIsTheCentroid) {
  for (const std::string& name : part_names()) {
    const Vec2 centroid = centroid_mm(catalogue_part(name).outline);
    EXPECT_NEAR(centroid.x, 0.0, 1e-9) << name;
    EXPECT_NEAR(centroid.y, 0.0, 1e-9) << name;
  }
}

TEST(Catalogue, SymmetricPartsMapOntoThemselves) {
  for (const std::string& name : part_names()) {
    const Part part = catalogue_part(name);
    const int fold = part.symmetry_fold == 0 ? 12 : part.symmetry_fold;  // circles: 12 n chords
    for (int k = 1; k < fold; ++k) {
      const double angle = 2.0 * kPi * k / fold;
      EXPECT_GT(overlap(part, [&](Vec2 p) { return turned(p, angle); }), 0.99999) << name << k;
    }
  }
}

TEST(Catalogue, NoPartHasMoreSymmetryThanItSays) {
  for (const std::string& name : part_names()) {
    const Part part = catalogue_part(name);
    if (part.symmetry_fold == 0) continue;
    for (int deg = 20; deg <= 340; deg += 10) {
      if (deg % (360 / part.symmetry_fold) == 0) continue;
      const double angle = deg * kRadPerDeg;
      EXPECT_LT(overlap(part, [&](Vec2 p) { return turned(p, angle); }), 0.96) << name << deg;
    }
  }
}

TEST(Catalogue, AreasCountInTheSymmetry) {
  // Without its rib and its hole the plate would be 2-fold.
  Part plate = catalogue_part("plate");
  const auto half_turn = [](Vec2 p) { return turned(p, kPi); };
  EXPECT_LT(overlap(plate, half_turn), 0.9);
  plate.outline.holes.clear();
  const double with_rib = overlap(make_part(plate), half_turn);
  plate.areas.clear();
  EXPECT_GT(overlap(make_part(plate), half_turn), 0.99999);
  EXPECT_LT(with_rib, 0.9);
}

TEST(Catalogue, TriangleIsNotEvenNearlyThreeFold) {
  // Sides of 128, 132 and 117 mm before the corners are rounded, and the bore off the centroid.
  const Part triangle = catalogue_part("triangle");
  EXPECT_EQ(triangle.symmetry_fold, 1);
  for (const double angle : {2.0 * kPi / 3.0, 4.0 * kPi / 3.0}) {
    EXPECT_LT(overlap(triangle, [&](Vec2 p) { return turned(p, angle); }), 0.92);
  }
}

TEST(Catalogue, PadHasNoMirrorSymmetry) {
  const Part pad = catalogue_part("pad");
  double best = 0.0;
  for (int deg = 0; deg < 360; deg += 4) {
    const double angle = deg * kRadPerDeg;
    best = std::max(best, overlap(pad, [&](Vec2 p) { return turned({-p.x, p.y}, angle); }));
  }
  EXPECT_LT(best, 0.95);
}

TEST(Catalogue, PadAndLookalikeAreAlikeButNotTheSame) {
  const Part pad = catalogue_part("pad");
  const Part other = catalogue_part("lookalike");
  EXPECT_NEAR(area_mm2(other) / area_mm2(pad), 1.0, 0.15);
  EXPECT_NEAR(radius_mm(other) / radius_mm(pad), 1.0, 0.1);
  EXPECT_NE(pad.outline.holes.size(), other.outline.holes.size());
}

TEST(Catalogue, PadHasTheSizeOfTheThesisFigures) {
  const Part pad = catalogue_part("pad");
  Vec2 low{1e9, 1e9}, high{-1e9, -1e9};
  for (const Vec2 p : pad.outline.outer) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  EXPECT_NEAR(high.x - low.x, 150.0, 3.0);
  EXPECT_NEAR(high.y - low.y, 70.0, 3.0);
  EXPECT_EQ(pad.thickness_mm, 8.0);
  ASSERT_EQ(pad.outline.holes.size(), 2u);
  EXPECT_GT(signed_area_mm2(pad.outline.holes[0]), 2.0 * signed_area_mm2(pad.outline.holes[1]));
}

TEST(Part, WasherAndCylinderHaveTheAreasOfTheirCircles) {
  EXPECT_NEAR(area_mm2(catalogue_part("washer")), kPi * (32 * 32 - 16 * 16), 4.0);
  EXPECT_NEAR(area_mm2(catalogue_part("cylinder")), kPi * 32 * 32, 3.0);
  EXPECT_NEAR(contour_length_mm(catalogue_part("washer")), 2 * kPi * (32 + 16), 0.2);
}

TEST(Part, RowSaysWhatTheTopSaysAtEveryPoint) {
  for (const std::string& name : part_names()) {
    const Part part = catalogue_part(name);
    for (double y = -70.0; y < 71.0; y += 3.5) {
      const TopRow row(part, y);
      for (double x = -80.0; x < 81.0; x += 0.75) {
        ASSERT_EQ(row.height_mm(x), top_height_mm(part, {x, y})) << name << " " << x << " " << y;
      }
    }
  }
}

TEST(Part, LaterAreaHoldsWhereTwoOverlap) {
  Part part{.name = "x", .outline = {}, .thickness_mm = 5.0, .areas = {}};
  part.outline = {rectangle({}, 100, 100), {circle({40, 40}, 5)}};
  part.areas = {{rectangle({}, 40, 40), 3.0}, {rectangle({10, 0}, 20, 20), -2.0}};
  // The hole is not in the middle, so the origin moves; ask where it went.
  const Vec2 shift = -1.0 * centroid_mm(part.outline);
  part = make_part(part);
  EXPECT_EQ(top_height_mm(part, shift + Vec2{-10, 0}), 3.0);
  EXPECT_EQ(top_height_mm(part, shift + Vec2{10, 0}), -2.0);
  EXPECT_EQ(top_height_mm(part, shift + Vec2{30, 0}), 0.0);
  EXPECT_EQ(top_height_mm(part, shift + Vec2{40, 40}), std::nullopt);
  EXPECT_EQ(top_height_mm(part, shift + Vec2{60, 0}), std::nullopt);
  EXPECT_EQ(height_max_mm(part), 3.0);
}

TEST(Part, RefusesWhatCannotBeMade) {
  const auto make = [](auto spoil) {
    Part part{.name = "x", .outline = {}, .thickness_mm = 5.0, .areas = {}};
    part.outline.outer = rectangle({}, 100, 100);
    spoil(part);
    return make_part(part);
  };
  EXPECT_NO_THROW((void)make([](Part&) {}));
  EXPECT_THROW((void)make([](Part& p) { p.thickness_mm = 0.0; }), std::invalid_argument);
  EXPECT_THROW((void)make([](Part& p) { p.outline.outer.resize(2); }), std::invalid_argument);
  EXPECT_THROW((void)make([](Part& p) {
                 p.areas = {{circle({}, 9), -5.0}};
               }),
               std::invalid_argument);
  EXPECT_THROW(
      (void)make([](Part& p) { std::reverse(p.outline.outer.begin(), p.outline.outer.end()); }),
      std::invalid_argument);
  EXPECT_NO_THROW((void)make([](Part& p) { p.areas.assign(62, {circle({}, 9), 1.0}); }));
  EXPECT_THROW((void)make([](Part& p) {
                 p.areas.assign(63, {circle({}, 9), 1.0});
               }),
               std::invalid_argument);
  EXPECT_THROW((void)make([](Part& p) { p.outline.holes = {rectangle({}, 200, 200)}; }),
               std::invalid_argument);
}

}  // namespace
}  // namespace flatpose::sim
