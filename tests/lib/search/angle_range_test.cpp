// How far a template has to be turned about an anchor until it looks alike.

#include <gtest/gtest.h>

#include "flatpose/core/maths.hpp"
#include "flatpose/search/grid_search.hpp"

namespace flatpose::search {
namespace {

constexpr model::Symmetry kRound{model::kFullSymmetry, 12.0, -5.0};

model::Anchor anchor_at(double x_mm, double y_mm, double clearance_mm) {
  return {static_cast<float>(x_mm), static_cast<float>(y_mm), static_cast<float>(clearance_mm)};
}

TEST(AngleRange, IsATurnOverTheOrder) {
  for (int order = 1; order <= 8; ++order) {
    for (const auto& anchor : {anchor_at(0, 0, 10), anchor_at(30, 2, 5)})
      EXPECT_EQ(angle_range_rad({order, 12.0, -5.0}, anchor), 2.0 * kPi / order);
  }
}

TEST(AngleRange, IsNoughtAtTheCentreOfFullSymmetry) {
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(12, -5, 20)), 0.0);
  EXPECT_EQ(angle_count(0.0, 0.1), 1);
  // A tenth of the disc about the anchor is as good as the centre.
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(13.9, -5, 20)), 0.0);
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(12, -6.9, 20)), 0.0);
}

TEST(AngleRange, IsAWholeTurnBesideTheCentreOfFullSymmetry) {
  // The centre may then lie in any direction from the anchor.
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(14.1, -5, 20)), 2.0 * kPi);
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(12, -2.9, 20)), 2.0 * kPi);
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(0, 0, 20)), 2.0 * kPi);
  EXPECT_EQ(angle_range_rad(kRound, anchor_at(12.1, -5, 0)), 2.0 * kPi);
}

}  // namespace
}  // namespace flatpose::search
