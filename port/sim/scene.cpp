#include "port/sim/scene.hpp"

#include <stdexcept>
#include <utility>

#include "port/sim/layout.hpp"

namespace flatpose::sim {
namespace {

void add_wall(Layout& layout, Vec2 center_mm, double size_x_mm, double size_y_mm,
              double height_mm) {
  Part wall{.name = "wall", .outline = {}, .thickness_mm = height_mm, .areas = {}};
  wall.outline.outer = rectangle({}, size_x_mm, size_y_mm);
  layout.result.fixtures.push_back({std::make_shared<const Part>(make_part(std::move(wall))),
                                    {Rotation{}, {center_mm.x, center_mm.y, height_mm}}});
}

void add_bin(Layout& layout, const Bin& bin) {
  if (!(bin.inner_x_mm > 0.0 && bin.inner_y_mm > 0.0 && bin.height_mm > 0.0 && bin.wall_mm > 0.0)) {
    throw std::invalid_argument("bin: all four sizes must be > 0");
  }
  const double x_mm = 0.5 * (bin.inner_x_mm + bin.wall_mm);
  const double y_mm = 0.5 * (bin.inner_y_mm + bin.wall_mm);
  const double outer_x_mm = bin.inner_x_mm + 2.0 * bin.wall_mm;
  add_wall(layout, {0.0, -y_mm}, outer_x_mm, bin.wall_mm, bin.height_mm);
  add_wall(layout, {0.0, y_mm}, outer_x_mm, bin.wall_mm, bin.height_mm);
  add_wall(layout, {-x_mm, 0.0}, bin.wall_mm, bin.inner_y_mm, bin.height_mm);
  add_wall(layout, {x_mm, 0.0}, bin.wall_mm, bin.inner_y_mm, bin.height_mm);
}

struct Entry {
  const char* name;
  const char* default_part;
  void (*build)(Layout&);
};

constexpr Entry kEntries[] = {
    {"single", "pad", build_single},
    {"lone", "pad", build_lone},
    {"low", "pad", build_low},
    {"tilt", "pad", build_tilt},
    {"empty", "pad", build_empty},
    {"cyl_loose", "cylinder", build_cyl_loose},
    {"cyl_grid", "cylinder", build_cyl_grid},
    {"cyl_brick", "cylinder", build_cyl_brick},
    {"medium", "pad", build_medium},
    {"high", "pad", build_high},
    {"pile", "pad", build_pile},
    {"absent", "pad", build_absent},
    {"steep", "pad", build_steep},
    {"buried", "pad", build_buried},
};

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Entry& entry : kEntries) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

Scene make_scene(const SceneConfig& config, const SensorConfig& sensor, std::uint64_t seed) {
  std::string known;
  for (const Entry& entry : kEntries) {
    known += known.empty() ? entry.name : std::string(", ") + entry.name;
    if (config.scene != entry.name) continue;
    Layout layout(config, sensor, seed);
    layout.target = layout.part(config.part.empty() ? entry.default_part : config.part);
    layout.result.part = layout.target->name;
    if (config.bin) add_bin(layout, *config.bin);
    entry.build(layout);
    return std::move(layout.result);
  }
  throw std::invalid_argument("unknown scene '" + config.scene + "'; scenes: " + known);
}

}  // namespace flatpose::sim
