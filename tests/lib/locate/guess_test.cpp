// Poses that fit all that is seen and are guesses all the same: what is covered would tell.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "flatpose/model/landmarks.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::locate {
namespace {

using test::Locating;
using test::MadeScan;

const Pose kTruth = test::pose_at(75.2, 60.4, test::kPartTop_mm, 0.35);

struct Hole {
  double x_mm;
  double y_mm;
  double radius_mm;
};
constexpr Hole kLarge{-26.0, 6.0, 8.0};
constexpr Hole kSmall{26.0, 6.0, 4.0};

/// 80 x 36 mm with two holes beside its long axis; on its face it would show them with their sizes
/// swapped.
model::Template holed_part() {
  model::Template part = test::rectangle_part(80.0, 36.0, test::kPartTop_mm);
  for (const Hole& h : {kLarge, kSmall}) {
    const int count = static_cast<int>(kPi * h.radius_mm);
    for (int i = 0; i < count; ++i) {
      const double a = 2.0 * kPi * i / count;
      part.contour[part.contour_count++] = test::contour_point(
          h.x_mm + h.radius_mm * std::cos(a), h.y_mm + h.radius_mm * std::sin(a), -std::cos(a),
          -std::sin(a), test::kPartTop_mm);
    }
    int kept = 0;
    for (int i = 0; i < part.surface_count; ++i) {
      const model::SurfacePoint p = part.surface[i];
      if (std::hypot(p.x_mm - h.x_mm, p.y_mm - h.y_mm) > h.radius_mm + 3.0)
        part.surface[kept++] = p;
    }
    part.surface_count = kept;
  }
  part.anchors[0] = {0.0F, -2.0F, 14.0F};
  part.landmarks = model::find_landmarks(part);
  return part;
}

/// The part, seen from the side that is asked for, with slabs over the given places of it.
LocateResult located(const model::Template& part, bool on_its_face,
                     const std::function<bool(const Vec3&)>& is_covered, double width_mm,
                     double height_mm, bool has_holes) {
  const MadeScan scan(
      150, 120, 1.0,
      [&](double x, double y) {
        Vec3 p = kTruth.inverse() * Vec3{x, y, test::kPartTop_mm};
        if (is_covered(p)) return 30.0;
        if (on_its_face) p.x = -p.x;
        if (std::fabs(p.x) > 0.5 * width_mm || std::fabs(p.y) > 0.5 * height_mm) return 0.0;
        for (const Hole& h : {kLarge, kSmall})
          if (has_holes && std::hypot(p.x - h.x_mm, p.y - h.y_mm) < h.radius_mm) return 0.0;
        return test::kPartTop_mm;
      },
      0.05);
  Locating locating;
  LocateConfig config;
  config.min_score = 0.75;
  EXPECT_EQ(locating.run(part, scan.view(), config), Status::kOk);
  return locating.result;
}

LocateResult located_holed(bool on_its_face, const std::function<bool(const Vec3&)>& is_covered) {
  return located(holed_part(), on_its_face, is_covered, 80.0, 36.0, true);
}

bool over_large(const Vec3& p) {
  return std::fabs(p.x + 26.0) < 11.0 && std::fabs(p.y - 6.0) < 11.0;
}
bool over_small(const Vec3& p) {
  return std::fabs(p.x - 26.0) < 11.0 && std::fabs(p.y - 6.0) < 11.0;
}

TEST(Guess, AHoleInSightTellsTheFace) {
  EXPECT_EQ(located_holed(false, [](const Vec3&) { return false; }).match_count, 1);
  EXPECT_EQ(located_holed(false, over_small).match_count, 1);
  EXPECT_EQ(located_holed(false, over_large).match_count, 1);
  EXPECT_EQ(located_holed(true, [](const Vec3&) { return false; }).match_count, 0);
  EXPECT_EQ(located_holed(true, over_small).match_count, 0);
  EXPECT_EQ(located_holed(true, over_large).match_count, 0);
}

TEST(Guess, SurfaceWhereAHoleWouldBeTellsTheFace) {
  // Only the rim of the small hole is covered; around it the surface shows that the large one,
  // which would be there on its face, is not.
  const auto over_rims = [](const Vec3& p) {
    return over_large(p) || std::hypot(p.x - kSmall.x_mm, p.y - kSmall.y_mm) < 5.0;
  };
  EXPECT_EQ(located_holed(false, over_rims).match_count, 1);
}

TEST(Guess, WithEveryHoleCoveredTheFaceIsNotKnown) {
  const auto over_both = [](const Vec3& p) { return over_large(p) || over_small(p); };
  for (const bool on_its_face : {false, true}) {
    const LocateResult r = located_holed(on_its_face, over_both);
    EXPECT_EQ(r.match_count, 0);
    EXPECT_GT(r.best_rejected_score, 0.9) << "it fits, but it is a guess";
  }
}

TEST(Guess, APartThatSlidesUnderItsCoverIsNone) {
  model::Template strip = test::rectangle_part(90.0, 24.0, test::kPartTop_mm);
  strip.symmetry.order = 2;
  const auto found = [&](const std::function<bool(const Vec3&)>& is_covered) {
    return located(strip, false, is_covered, 90.0, 24.0, false).match_count;
  };
  EXPECT_EQ(found([](const Vec3&) { return false; }), 1);
  EXPECT_EQ(found([](const Vec3& p) { return p.x > 35.0 && p.x < 60.0; }), 1);
  EXPECT_EQ(found([](const Vec3& p) { return std::fabs(p.x) > 35.0 && std::fabs(p.x) < 60.0; }), 0);
}

}  // namespace
}  // namespace flatpose::locate
