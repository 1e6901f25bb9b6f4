// Resting poses worked out by hand.

#include "port/sim/settle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "port/sim/random.hpp"
#include "tests/port/sim/box.hpp"
#include "tests/port/sim/columns.hpp"

namespace flatpose::sim {
namespace {

constexpr double kAnyLean = 1.0;

std::shared_ptr<const Part> slab(double size_x_mm, double size_y_mm, double thickness_mm) {
  return box({}, size_x_mm, size_y_mm, thickness_mm).part;
}

Heap heap_of(const std::vector<Instance>& bodies) {
  Heap heap;
  for (const Instance& body : bodies) heap.add(body);
  return heap;
}

double falls_toward_x_rad(const Rest& rest) {
  const Vec3 up = rest.scan_T_object.rotation.column(2);
  EXPECT_NEAR(up.y, 0.0, 1e-3);
  return std::atan2(up.x, up.z);
}

void expect_held(const Rest& rest) {
  const auto& c = rest.contacts_mm;
  const Vec3& p = rest.center_of_mass_mm;
  const auto side = [&](const Vec3& a, const Vec3& b) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  const double turns[] = {side(c[0], c[1]), side(c[1], c[2]), side(c[2], c[0])};
  const bool left = turns[0] >= -1e-6 && turns[1] >= -1e-6 && turns[2] >= -1e-6;
  const bool right = turns[0] <= 1e-6 && turns[1] <= 1e-6 && turns[2] <= 1e-6;
  EXPECT_TRUE(left || right);
}

TEST(Settle, PlateOnTheFloorLiesLevelWhereItWasLetDown) {
  Heap heap;
  const auto rest = settle(heap, {slab(100, 60, 4), 30, -20, 0.7}, kAnyLean);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(rest->tilt_rad, 0.0, 1e-6);
  EXPECT_LT(norm(rest->scan_T_object.position_mm - Vec3{30, -20, 4}), 1e-6);
  const Vec3 x = rest->scan_T_object.rotation.column(0);
  EXPECT_NEAR(std::atan2(x.y, x.x), 0.7, 1e-9);
  for (const Vec3& contact : rest->contacts_mm) EXPECT_NEAR(contact.z, 0.0, 1e-9);
  expect_held(*rest);
}

TEST(Settle, PlateOverTheEdgeOfABoxLeansFromTheEdgeToTheFloor) {
  // The box ends at x = 0. A plate 100 long and 4 thick that falls by tan = 3 / 4 toward +x: with
  // its centre at x = 11.2, the middle of its lower face is at 11.2 - 2 * 0.6 = 10, its lower end
  // 50 further on the floor, so 30 below; over the box's edge the face is at 30 + 10 * 3 / 4.
  Heap heap = heap_of({box({-100, 0, 37.5}, 200, 200, 37.5)});
  const auto rest = settle(heap, {slab(100, 60, 4), 11.2, 0, 0}, kAnyLean);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(falls_toward_x_rad(*rest), std::atan(0.75), 1e-3);
  EXPECT_NEAR(rest->center_of_mass_mm.z, 30.0 + 2.0 * 0.8, 0.05);
  double highest_mm = 0.0, lowest_mm = 100.0;
  for (const Vec3& contact : rest->contacts_mm) {
    highest_mm = std::max(highest_mm, contact.z);
    lowest_mm = std::min(lowest_mm, contact.z);
    EXPECT_NEAR(contact.x, contact.z > 1.0 ? 0.0 : 10.0 + 50.0 * 0.8, 0.1);
  }
  EXPECT_NEAR(highest_mm, 37.5, 1e-6);
  EXPECT_NEAR(lowest_mm, 0.0, 1e-6);
  expect_held(*rest);
}

TEST(Settle, RefusesToLeanMoreThanItIsAllowed) {
  Heap heap = heap_of({box({-100, 0, 37.5}, 200, 200, 37.5)});
  EXPECT_FALSE(settle(heap, {slab(100, 60, 4), 11.2, 0, 0}, 0.64));  // 0.6435 by hand, above
  EXPECT_TRUE(settle(heap, {slab(100, 60, 4), 11.2, 0, 0}, 0.65));
}

TEST(Settle, PlateWithItsCenterOverTheBoxStaysLevel) {
  Heap heap = heap_of({box({-100, 0, 37.5}, 200, 200, 37.5)});
  const auto rest = settle(heap, {slab(100, 60, 4), -1.0, 0, 0}, kAnyLean);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(rest->tilt_rad, 0.0, 1e-6);
  EXPECT_NEAR(rest->scan_T_object.position_mm.z, 41.5, 1e-6);
}

TEST(Settle, PlateOnTwoEqualBoxesIsLevelOnBoth) {
  Heap heap = heap_of({box({-50, 0, 25}, 20, 20, 25), box({50, 0, 25}, 20, 20, 25)});
  const auto rest = settle(heap, {slab(140, 40, 6), 5, 2, 0.1}, kAnyLean);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(rest->tilt_rad, 0.0, 1e-6);
  EXPECT_NEAR(rest->scan_T_object.position_mm.z, 31.0, 1e-6);
  expect_held(*rest);
}

TEST(Settle, PlateOnThreePostsLiesInTheirPlane) {
  // z = 16 + 0.1 x + 0.1 y holds at (-30, -30, 10), (30, -30, 16), (0, 40, 20).
  Heap heap = heap_of({box({-30, -30, 10}, 0.02, 0.02, 10), box({30, -30, 16}, 0.02, 0.02, 16),
                       box({0, 40, 20}, 0.02, 0.02, 20)});
  const auto rest = settle(heap, {slab(150, 150, 4), 3, -2, 1.2}, kAnyLean);
  ASSERT_TRUE(rest);
  const Vec3 up = rest->scan_T_object.rotation.column(2);
  EXPECT_NEAR(-up.x / up.z, 0.1, 1e-3);
  EXPECT_NEAR(-up.y / up.z, 0.1, 1e-3);
  const Vec3 bottom_mm = rest->scan_T_object * Vec3{0, 0, -4};
  EXPECT_NEAR(bottom_mm.z, 16.0 + 0.1 * bottom_mm.x + 0.1 * bottom_mm.y, 0.02);
  expect_held(*rest);
}

TEST(Settle, HoleSlipsOverAPost) {
  Part drawn{.name = "ring", .outline = {}, .thickness_mm = 5.0, .areas = {}};
  drawn.outline = {rectangle({}, 60, 60), {circle({}, 12)}};
  const auto ring = std::make_shared<const Part>(make_part(drawn));
  Heap heap = heap_of({box({0, 0, 40}, 8, 8, 40)});
  const auto over = settle(heap, {ring, 0, 0, 0.3}, kAnyLean);
  ASSERT_TRUE(over);
  EXPECT_NEAR(over->scan_T_object.position_mm.z, 5.0, 1e-6);
  EXPECT_FALSE(settle(heap, {ring, 20, 0, 0.3}, 0.5));  // leans on it instead, by more than that
}

TEST(Settle, PartOnItsFaceLeansOnItsRib) {
  // A rib 3 high from x = 20 to 30 under the plate: it stands on the rib's inner foot and on the
  // plate's far rim at x = -50, 70 away.
  Part drawn{.name = "ribbed", .outline = {}, .thickness_mm = 4.0, .areas = {}};
  drawn.outline.outer = rectangle({}, 100, 60);
  drawn.areas = {{rectangle({25, 0}, 10, 40), 3.0}};
  const auto ribbed = std::make_shared<const Part>(make_part(drawn));
  Heap heap;
  const auto rest = settle(heap, {ribbed, 0, 0, 0, true}, kAnyLean);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(rest->tilt_rad, std::atan(3.0 / 70.0), 1e-3);
  const Vec3 up = -rest->scan_T_object.rotation.column(2);
  EXPECT_NEAR(std::atan2(-up.x, up.z), std::atan(3.0 / 70.0), 1e-3);  // rises toward +x
  EXPECT_NEAR((rest->scan_T_object * Vec3{-50, 0, 0}).z, 0.0, 0.02);
  expect_held(*rest);
}

TEST(Settle, OverhangingSideStaysClearOfWhatStandsBeside) {
  // The lean of the plate over the box's edge carries its upper rim beyond its lower one, where a
  // post stands against it. However it comes to rest, it is in neither.
  const std::vector<Instance> bodies{box({-100, 0, 20}, 200, 200, 20), box({53, 0, 15}, 4, 60, 15)};
  Heap heap = heap_of(bodies);
  const auto part = slab(100, 60, 20);
  for (const double x_mm : {3.0, 5.0, 7.0}) {
    const auto rest = settle(heap, {part, x_mm, 0, 0}, kAnyLean);
    if (!rest) continue;  // it may rock
    Scene scene = scene_of(bodies);
    scene.instances.push_back({part, rest->scan_T_object});
    EXPECT_LT(Columns(scene, 0.5).deepest_overlap_mm(), 0.2) << x_mm;
  }
}

TEST(Settle, ContactsOfAHeapTouchAndHold) {
  Heap heap;
  Random random(6);
  int rested = 0;
  for (int i = 0; i < 60; ++i) {
    const auto& names = part_names();
    const auto part = std::make_shared<const Part>(catalogue_part(names[i % names.size()]));
    const Drop drop{part, random.uniform(-120, 120), random.uniform(-90, 90), random.uniform(-3, 3),
                    i % 3 == 0};
    const auto rest = settle(heap, drop, 0.5);
    if (!rest) continue;
    ++rested;
    expect_held(*rest);
    const Pose object_T_scan = rest->scan_T_object.inverse();
    const Solid solid(part);
    for (const Vec3& contact : rest->contacts_mm) {
      // A little aside from the rim, toward the centre, the ray up from below finds the part.
      constexpr double kAside = 1e-4, kBelowMm = 50.0;
      const Vec3 aside = kAside * (rest->center_of_mass_mm - contact);
      const Vec3 from = contact + Vec3{aside.x, aside.y, -kBelowMm};
      const auto hit = solid.first_hit(
          {object_T_scan * from, object_T_scan.rotation * Vec3{0, 0, 1}}, 0.0, 100.0);
      if (!hit || hit->face == Face::kSide) continue;  // past a hole's rim, or a side
      EXPECT_NEAR(hit->distance_mm, kBelowMm, 2.0 * kRestErrorMm) << part->name;
    }
    heap.add({part, rest->scan_T_object});
  }
  EXPECT_GT(rested, 20);
}

TEST(Settle, ForgetsTheBodyRemoved) {
  Heap heap = heap_of({box({0, 0, 30}, 200, 200, 30)});
  const Drop drop{slab(50, 50, 5), 0, 0, 0};
  EXPECT_NEAR(settle(heap, drop, kAnyLean)->scan_T_object.position_mm.z, 35.0, 1e-6);
  heap.remove_last();
  EXPECT_NEAR(settle(heap, drop, kAnyLean)->scan_T_object.position_mm.z, 5.0, 1e-6);
}

}  // namespace
}  // namespace flatpose::sim
