// The parts that scenes are made of, in mm.

#include <stdexcept>

#include "flatpose/core/maths.hpp"
#include "port/sim/part.hpp"

namespace flatpose::sim {
namespace {

constexpr double rad(double angle_deg) { return angle_deg * kRadPerDeg; }

/// About 150 x 70. Holes of 18 and 10 mm and corners cut by 10 and 4 mm tell left from right, so a
/// pad that lies on its face has another outline.
Part pad() {
  Part part{.name = "pad", .outline = {}, .thickness_mm = 8.0, .areas = {}};
  part.outline.outer = annular_sector({.inner_radius_mm = 74.0,
                                       .outer_radius_mm = 130.0,
                                       .half_angle_rad = rad(37.5),
                                       .outer_right_cut_mm = 10.0,
                                       .outer_left_cut_mm = 4.0,
                                       .inner_left_cut_mm = 3.0,
                                       .inner_right_cut_mm = 3.0});
  part.outline.holes = {circle(on_ring(104.0, rad(-22.0)), 9.0),
                        circle(on_ring(98.0, rad(20.0)), 5.0)};
  return part;
}

/// A pad of another car: nearly the same ring, three equal holes, other corners.
Part lookalike() {
  Part part{.name = "lookalike", .outline = {}, .thickness_mm = 8.0, .areas = {}};
  part.outline.outer = annular_sector({.inner_radius_mm = 77.0,
                                       .outer_radius_mm = 128.0,
                                       .half_angle_rad = rad(36.0),
                                       .outer_right_cut_mm = 3.0,
                                       .outer_left_cut_mm = 3.0,
                                       .inner_left_cut_mm = 9.0,
                                       .inner_right_cut_mm = 3.0});
  part.outline.holes = {circle(on_ring(100.0, rad(-25.0)), 6.0), circle(on_ring(92.0, 0.0), 6.0),
                        circle(on_ring(106.0, rad(24.0)), 6.0)};
  return part;
}

Part washer() {
  Part part{.name = "washer", .outline = {}, .thickness_mm = 4.0, .areas = {}, .symmetry_fold = 0};
  part.outline = {circle({}, 32.0), {circle({}, 16.0)}};
  return part;
}

Part bracket() {
  const Vec2 corners[] = {{0, 0}, {105, 0}, {105, 32}, {32, 32}, {32, 75}, {0, 75}};
  Part part{.name = "bracket", .outline = {}, .thickness_mm = 5.0, .areas = {}};
  part.outline = {rounded_polygon(corners, 4.0), {circle({84, 16}, 6.0), circle({16, 58}, 4.5)}};
  return part;
}

Part flange() {
  Part part{.name = "flange", .outline = {}, .thickness_mm = 10.0, .areas = {}, .symmetry_fold = 4};
  part.outline.outer = rectangle({}, 90.0, 90.0, 8.0);
  part.outline.holes = {circle({}, 20.0), circle({-33, -33}, 4.5), circle({33, -33}, 4.5),
                        circle({33, 33}, 4.5), circle({-33, 33}, 4.5)};
  return part;
}

Part strip() {
  Part part{.name = "strip", .outline = {}, .thickness_mm = 4.0, .areas = {}, .symmetry_fold = 2};
  part.outline.outer = rectangle({}, 130.0, 26.0, 5.0);
  part.outline.holes = {circle({-48, 0}, 5.0), circle({48, 0}, 5.0)};
  return part;
}

Part triangle() {
  const Vec2 corners[] = {{-62, -40}, {66, -40}, {-12, 66}};
  Part part{.name = "triangle", .outline = {}, .thickness_mm = 6.0, .areas = {}};
  part.outline = {rounded_polygon(corners, 8.0), {circle({-6, -8}, 13.0)}};
  return part;
}

Part plate() {
  Part part{.name = "plate", .outline = {}, .thickness_mm = 3.0, .areas = {}};
  part.outline = {rectangle({}, 130.0, 84.0, 6.0), {circle({44, -22}, 7.0)}};
  part.areas = {{rectangle({-8, 14}, 84.0, 14.0, 5.0), 3.0}};
  return part;
}

Part cylinder() {
  Part part{
      .name = "cylinder", .outline = {}, .thickness_mm = 60.0, .areas = {}, .symmetry_fold = 0};
  part.outline.outer = circle({}, 32.0);
  return part;
}

struct Entry {
  const char* name;
  Part (*draw)();
};
constexpr Entry kEntries[] = {
    {"pad", pad},           {"lookalike", lookalike}, {"washer", washer},
    {"bracket", bracket},   {"flange", flange},       {"strip", strip},
    {"triangle", triangle}, {"plate", plate},         {"cylinder", cylinder}};

}  // namespace

const std::vector<std::string>& part_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Entry& entry : kEntries) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

Part catalogue_part(const std::string& name) {
  std::string known;
  for (const Entry& entry : kEntries) {
    if (name == entry.name) return make_part(entry.draw());
    known += known.empty() ? entry.name : std::string(", ") + entry.name;
  }
  throw std::invalid_argument("unknown part '" + name + "'; parts: " + known);
}

}  // namespace flatpose::sim
