// How firmly a contour seen in part holds a part, against cases solved by hand.

#include "flatpose/locate/hold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/lib/locate/made_bin.hpp"

namespace flatpose::locate {
namespace {

template <class Confirmed>
double least_share(const model::Template& part, Confirmed&& confirmed) {
  Hold hold(part);
  for (const model::ContourPoint& p : part.contour_points()) hold.add(p, confirmed(p));
  return hold.least_share();
}

TEST(Hold, IsTheShareThatIsConfirmedWhenAllIsAlike) {
  for (const model::Template& part :
       {test::rectangle_part(80, 30, 5), test::rectangle_part(40, 40, 5), test::disc_part(25, 5)}) {
    for (const double share : {0.0, 0.25, 0.5, 1.0})
      EXPECT_NEAR(least_share(part, [share](const auto&) { return share; }), share, 1e-9);
  }
}

TEST(Hold, WithoutItsEndsAStripSlides) {
  const model::Template strip = test::rectangle_part(120, 20, 5);
  EXPECT_NEAR(least_share(strip, [](const auto& p) { return p.nx == 0.0F ? 1.0 : 0.0; }), 0.0,
              1e-9);
  // One end holds half of what both do.
  EXPECT_NEAR(least_share(strip, [](const auto& p) { return p.nx >= 0.0F ? 1.0 : 0.0; }), 0.5,
              0.02);
  // A tenth of one end: a twentieth.
  EXPECT_NEAR(least_share(strip,
                          [](const auto& p) {
                            return p.nx == 0.0F || (p.nx > 0.0F && p.y_mm > 6.5F) ? 1.0 : 0.0;
                          }),
              1.0 / 18.0, 0.01);
}

TEST(Hold, OneSideAloneLeavesAShiftOpen) {
  const model::Template part = test::rectangle_part(60, 40, 5);
  EXPECT_NEAR(least_share(part, [](const auto& p) { return p.ny > 0.0F ? 1.0 : 0.0; }), 0.0, 1e-9);
}

TEST(Hold, TheTurnOfADiscIsNoMatter) {
  const model::Template disc = test::disc_part(25, 5);
  // Half of the circle holds both shifts by a half.
  EXPECT_NEAR(least_share(disc, [](const auto& p) { return p.y_mm > 0.0F ? 1.0 : 0.0; }), 0.5,
              0.02);
  // Of the same contour the turn counts when the part is said to have one, and nothing holds it.
  model::Template dial = disc;
  dial.symmetry.order = 1;
  dial.contour[0].nx = 0.0F;
  dial.contour[0].ny = 1.0F;  // a notch at (25, 0)
  EXPECT_NEAR(least_share(dial, [&](const auto& p) { return &p == &dial.contour[0] ? 0.0 : 1.0; }),
              0.0, 0.05);
  EXPECT_NEAR(least_share(dial, [](const auto&) { return 1.0; }), 1.0, 1e-9);
}

TEST(Hold, OfNoContourIsWhole) { EXPECT_EQ(Hold(model::Template{}).least_share(), 1.0); }

}  // namespace
}  // namespace flatpose::locate
