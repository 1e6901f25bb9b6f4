#include "port/sim/underside.hpp"

#include <gtest/gtest.h>

#include <set>

#include "port/sim/random.hpp"
#include "tests/port/sim/columns.hpp"

namespace flatpose::sim {
namespace {

TEST(Underside, IsTheSameForTheMirrorSymmetricPartsOfTheCatalogue) {
  const std::set<std::string> same{"washer", "flange", "strip", "cylinder"};
  for (const std::string& name : part_names()) {
    EXPECT_EQ(same_upside_down(catalogue_part(name)), same.contains(name)) << name;
  }
}

TEST(Underside, IsTheSameWhateverWayThePartIsDrawn) {
  for (const double turn_rad : {0.0, 0.4, 2.0}) {
    const Rotation turn = rotation_about_z(turn_rad);
    const auto drawn = [&](double apex_x_mm) {
      std::vector<Vec2> corners;
      for (const Vec3 p : {Vec3{-40, 0, 0}, Vec3{40, 0, 0}, Vec3{apex_x_mm, 90, 0}}) {
        const Vec3 turned = turn * p;
        corners.push_back({turned.x, turned.y});
      }
      Part part{.name = "x", .outline = {}, .thickness_mm = 5.0, .areas = {}};
      part.outline.outer = rounded_polygon(corners, 5.0);
      return make_part(part);
    };
    EXPECT_TRUE(same_upside_down(drawn(0.0))) << turn_rad;
    EXPECT_FALSE(same_upside_down(drawn(8.0))) << turn_rad;
  }
}

TEST(Underside, IsAnotherWithAnAreaOrAHoleAside) {
  Part part{.name = "x", .outline = {}, .thickness_mm = 5.0, .areas = {}};
  part.outline.outer = rectangle({}, 90, 90);
  EXPECT_TRUE(same_upside_down(make_part(part)));
  Part raised = part;
  raised.areas = {{circle({}, 10), 1.0}};
  EXPECT_FALSE(same_upside_down(make_part(raised)));
  Part bored = part;
  bored.outline.holes = {circle({30, 10}, 4)};
  EXPECT_FALSE(same_upside_down(make_part(bored)));
}

TEST(Underside, FillsTheSameSpace) {
  Random random(5);
  const Instance pad{std::make_shared<const Part>(catalogue_part("pad")),
                     {rotation_from_vector({2.9, 0.3, -0.2}), {10, 20, 30}}};
  const Instance below = underside(pad);
  EXPECT_GT(below.scan_T_object.rotation.column(2).z, 0.0);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{random.uniform(-70, 90), random.uniform(-60, 100), random.uniform(0, 60)};
    EXPECT_EQ(in_material(pad, p), in_material(below, p));
    inside += in_material(pad, p);
  }
  EXPECT_GT(inside, 300);
}

}  // namespace
}  // namespace flatpose::sim
