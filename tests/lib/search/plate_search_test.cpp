// From a scan to candidates: a plate on a floor of any slope is where the search says.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flatpose/search/grid_search.hpp"
#include "tests/lib/scene/made_scene.hpp"
#include "tests/lib/search/made_parts.hpp"
#include "tests/lib/search/search_ground.hpp"

namespace flatpose::search {
namespace {

struct Floor {
  double slope_x, slope_y;
};

/// The best candidate for a plate of 44 mm x 28 mm in a scan.
Candidate best_candidate(const scene::Built& built, const model::Template& part) {
  SearchGround ground(built.scene, {});
  std::vector<Candidate> candidates(20);
  const auto result = grid_search(ground.images, ground.field, ground.places, part, 0, {},
                                  ground.memory.arena, candidates);
  EXPECT_TRUE(result);
  if (!result || result->candidate_count == 0) {
    ADD_FAILURE() << "no candidate";
    return {};
  }
  return candidates[0];
}

TEST(PlateSearch, FindsThePlateOnAFloorOfAnySlopeAtAnyAngle) {
  for (const auto& [slope_x, slope_y] :
       {Floor{0, 0}, {0.05, 0.05}, {0.3, -0.1}, {-0.25, -0.25}, {0.0, 0.55}}) {
    for (const double angle_rad : {0.0, 0.4, 1.2, -1.0}) {
      scene::Box box;
      box.angle_rad = angle_rad;
      scene::Surroundings s;
      s.slope_x = slope_x;
      s.slope_y = slope_y;
      s.noise_mm = 0.05;
      const scene::Built built(scene::scan_of(box, s), scene::config_for(s));
      ASSERT_EQ(built.status, Status::kOk);
      // The box is cut from the slope as seen from above: on the surface it is as much longer.
      const double stretch = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
      if (stretch > 1.05 && angle_rad != 0.0) continue;
      const auto part = plate(box.length_mm * std::sqrt(1.0 + slope_x * slope_x),
                              box.width_mm * std::sqrt(1.0 + slope_y * slope_y));
      const Candidate c = best_candidate(built, *part);
      const Vec3& p = c.work_T_object.position_mm;
      constexpr double kCoarse_mm = 2.0 * scene::kCell_mm;
      EXPECT_NEAR(p.x, box.x_mm, 2.0 * kCoarse_mm);
      EXPECT_NEAR(p.y, box.y_mm, 2.0 * kCoarse_mm);
      const double z_mm = box.height_mm + slope_x * p.x + slope_y * p.y;
      EXPECT_NEAR(p.z, z_mm, 0.3);
      const Vec3 normal = normalized({-slope_x, -slope_y, 1.0});
      EXPECT_GT(dot(c.work_T_object.rotation.column(2), normal), std::cos(2.0 * kRadPerDeg));
      const Vec3 x = c.work_T_object.rotation.column(0);
      const double turn_rad = std::atan2(x.y, x.x) - angle_rad;
      const double off_rad = turn_rad - kPi * std::round(turn_rad / kPi);
      EXPECT_NEAR(off_rad, 0.0, 0.2) << slope_x << ' ' << slope_y << ' ' << angle_rad;
    }
  }
}

}  // namespace
}  // namespace flatpose::search
