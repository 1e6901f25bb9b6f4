#include "port/sim/solid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "port/sim/random.hpp"

namespace flatpose::sim {
namespace {

std::shared_ptr<const Part> stepped_part() {
  Part part{.name = "stepped", .outline = {}, .thickness_mm = 20.0, .areas = {}};
  const Vec2 corners[] = {{0, 0}, {60, 0}, {60, 20}, {20, 20}, {20, 60}, {0, 60}};
  part.outline = {rounded_polygon(corners, 3.0), {circle({10, 10}, 6.0)}};
  part.areas = {{rectangle({40, 10}, 16, 10), 6.0}, {rectangle({10, 40}, 12, 20), -9.0}};
  return std::make_shared<const Part>(make_part(std::move(part)));
}

bool in_material(const Part& part, const Vec3& p) {
  const auto top = top_height_mm(part, {p.x, p.y});
  return top && p.z > -part.thickness_mm && p.z < *top;
}

Vec3 at(const Ray& ray, double t) { return ray.origin_mm + t * ray.direction; }

Vec3 random_direction(Random& random) {
  const auto [a, b] = random.normal_pair();
  return normalized(Vec3{a, b, random.normal_pair().first});
}

/// The hit is right when there is material just behind it and none before it.
void expect_first_material(const Solid& solid, const Ray& ray, double range_mm) {
  const auto hit = solid.first_hit(ray, 0.0, range_mm);
  const double end_mm = hit ? hit->distance_mm : range_mm;
  for (double t = 0.01; t < end_mm - 1e-6; t += 0.2) {
    ASSERT_FALSE(in_material(solid.part(), at(ray, t))) << "missed at " << t << " of " << end_mm;
  }
  if (!hit) return;
  EXPECT_TRUE(in_material(solid.part(), at(ray, end_mm + 1e-7)));
  if (hit->face == Face::kInside) return;
  EXPECT_FALSE(in_material(solid.part(), at(ray, end_mm - 1e-7)));
  EXPECT_NEAR(norm(hit->normal), 1.0, 1e-12);
  EXPECT_LE(dot(hit->normal, ray.direction), 0.0);
  // Off the face along its normal is air, into it is material.
  EXPECT_FALSE(in_material(solid.part(), at(ray, end_mm) + 1e-6 * hit->normal));
  EXPECT_TRUE(in_material(solid.part(), at(ray, end_mm) - 1e-6 * hit->normal));
}

TEST(Solid, EveryHitIsTheFirstMaterialFromAllSides) {
  Random random(3);
  const Solid solid(stepped_part());
  for (int i = 0; i < 3000; ++i) {
    const Vec3 aim{random.uniform(-30, 40), random.uniform(-30, 40), random.uniform(-22, 8)};
    const Vec3 direction = random_direction(random);
    expect_first_material(solid, {aim - 90.0 * direction, direction}, 180.0);
  }
}

TEST(Solid, EveryHitOnTheCatalogueIsTheFirstMaterialFromAbove) {
  Random random(4);
  for (const std::string& name : part_names()) {
    const Solid solid(std::make_shared<const Part>(catalogue_part(name)));
    for (int i = 0; i < 150; ++i) {
      const Vec3 aim{random.uniform(-80, 80), random.uniform(-60, 60), 0.0};
      Vec3 direction = random_direction(random);
      direction.z = -std::fabs(direction.z) - 0.3;
      direction = normalized(direction);
      expect_first_material(solid, {aim - 90.0 * direction, direction}, 180.0);
    }
  }
}

TEST(Solid, RaysAlongTheAxesThroughCornersAndEdgesAreRight) {
  Part part{.name = "cube", .outline = {}, .thickness_mm = 10.0, .areas = {}};
  part.outline.outer = rectangle({}, 10, 10);
  const Solid solid(std::make_shared<const Part>(make_part(part)));
  const auto from = [&](Vec3 origin, Vec3 direction) {
    return solid.first_hit({origin, normalized(direction)}, 0.0, 1000.0);
  };
  const auto top = from({2, 2, 100}, {0, 0, -1});
  ASSERT_TRUE(top);
  EXPECT_DOUBLE_EQ(top->distance_mm, 100.0);
  EXPECT_EQ(top->face, Face::kTop);
  const auto bottom = from({2, 2, -100}, {0, 0, 1});
  ASSERT_TRUE(bottom);
  EXPECT_DOUBLE_EQ(bottom->distance_mm, 90.0);
  EXPECT_EQ(bottom->face, Face::kBottom);
  const auto side = from({100, 0, -5}, {-1, 0, 0});
  ASSERT_TRUE(side);
  EXPECT_DOUBLE_EQ(side->distance_mm, 95.0);
  EXPECT_EQ(side->face, Face::kSide);
  EXPECT_EQ(side->normal, (Vec3{1, 0, 0}));
  const auto corner = from({100, 100, -5}, {-1, -1, 0});  // through a vertical edge
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->distance_mm, 95.0 * std::sqrt(2.0), 1e-9);
  EXPECT_FALSE(from({100, 5.5, -5}, {-1, 0, 0}));
  EXPECT_FALSE(from({100, 0, 0.5}, {-1, 0, 0}));
  EXPECT_FALSE(from({100, 0, -5}, {1, 0, 0}));
}

TEST(Solid, KeepsTheRangeItIsAskedFor) {
  Part part{.name = "cube", .outline = {}, .thickness_mm = 10.0, .areas = {}};
  part.outline.outer = rectangle({}, 10, 10);
  const Solid solid(std::make_shared<const Part>(make_part(part)));
  const Ray down{{0, 0, 100}, {0, 0, -1}};
  EXPECT_FALSE(solid.first_hit(down, 0.0, 99.9));
  EXPECT_FALSE(solid.first_hit(down, 110.1, 200.0));
  const auto inside = solid.first_hit(down, 105.0, 200.0);
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->face, Face::kInside);
  EXPECT_DOUBLE_EQ(inside->distance_mm, 105.0);
}

}  // namespace
}  // namespace flatpose::sim
