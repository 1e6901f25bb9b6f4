#include "port/sim/scene.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "port/sim/random.hpp"

namespace flatpose::sim {
namespace {

constexpr int kPlacesTriedMax = 10000;
constexpr double kGapMm = 10.0;  // between parts, and to the field's border or the wall

std::shared_ptr<const Part> shared_part(const std::string& name) {
  return std::make_shared<const Part>(catalogue_part(name));
}

/// A scene while it is being laid out.
class Layout {
 public:
  Layout(const SceneConfig& scene, const SensorConfig& sensor, std::uint64_t seed)
      : config(scene), ruler(sensor), random(seed, 0x5CE7E) {
    result.name = config.scene;
  }

  /// Lays the part flat on the floor, clear of all others. False when there is no room.
  bool place(const std::shared_ptr<const Part>& part, std::optional<double> turn_rad = {}) {
    const double reach_mm = radius_mm(*part) + kGapMm;
    const double turned_rad = turn_rad.value_or(random.uniform(-kPi, kPi));
    const SensorConfig& field = ruler.config();
    for (int i = 0; i < kPlacesTriedMax; ++i) {
      const Vec3 p_mm{random.uniform(-0.5, 0.5) * field.field_x_mm,
                      random.uniform(-0.5, 0.5) * field.field_y_mm, part->thickness_mm};
      if (!has_room(p_mm, reach_mm, height_max_mm(*part))) continue;
      result.instances.push_back({part, {rotation_about_z(turned_rad), p_mm}});
      return true;
    }
    return false;
  }

  void place_or_throw(const std::shared_ptr<const Part>& part,
                      std::optional<double> turn_rad = {}) {
    if (!place(part, turn_rad)) {
      throw std::runtime_error("scene '" + config.scene + "': no room for part '" + part->name +
                               "' in the field; enlarge the field");
    }
  }

  const SceneConfig& config;
  Ruler ruler;
  Random random;
  std::shared_ptr<const Part> target;
  Scene result;

 private:
  [[nodiscard]] bool has_room(const Vec3& p_mm, double reach_mm, double raised_mm) const {
    for (const double sx : {-reach_mm, reach_mm}) {
      for (const double sy : {-reach_mm, reach_mm}) {
        if (!ruler.in_field(p_mm + Vec3{sx, sy, raised_mm})) return false;
      }
    }
    if (config.bin && (std::fabs(p_mm.x) + reach_mm > 0.5 * config.bin->inner_x_mm ||
                       std::fabs(p_mm.y) + reach_mm > 0.5 * config.bin->inner_y_mm)) {
      return false;
    }
    return std::none_of(result.instances.begin(), result.instances.end(),
                        [&](const Instance& other) {
                          const Vec3& q_mm = other.scan_T_object.position_mm;
                          const double apart_mm = reach_mm + radius_mm(*other.part);
                          const double dx = p_mm.x - q_mm.x;
                          const double dy = p_mm.y - q_mm.y;
                          return dx * dx + dy * dy < apart_mm * apart_mm;
                        });
  }
};

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

void build_single(Layout& layout) { layout.place_or_throw(layout.target, layout.config.turn_rad); }

void build_lone(Layout& layout) {
  for (int i = 0; i < 2; ++i) layout.place_or_throw(layout.target);
}

/// `count` parts of the catalogue, none twice, without the target; no cylinders, which are no
/// clutter of pads.
std::vector<std::shared_ptr<const Part>> others(Layout& layout, int count) {
  std::vector<std::string> names = part_names();
  std::erase(names, layout.target->name);
  std::erase(names, "cylinder");
  std::vector<std::shared_ptr<const Part>> drawn;
  for (int i = 0; i < count; ++i) {
    const int pick = layout.random.index(static_cast<int>(names.size()));
    drawn.push_back(shared_part(names[pick]));
    names.erase(names.begin() + pick);
  }
  return drawn;
}

void build_low(Layout& layout) {
  const auto clutter = others(layout, 3);
  layout.place_or_throw(layout.target);
  for (const auto& part : clutter) layout.place_or_throw(part);
}

void build_tilt(Layout& layout) {
  const SceneConfig& config = layout.config;
  const Vec3 position_mm{layout.random.uniform(-20.0, 20.0), layout.random.uniform(-20.0, 20.0),
                         config.held_height_mm};
  const double turn_rad = config.turn_rad.value_or(layout.random.uniform(-kPi, kPi));
  const Rotation rotation = rotation_from_vector({config.tilt_x_rad, 0.0, 0.0}) *
                            rotation_from_vector({0.0, config.tilt_y_rad, 0.0}) *
                            rotation_about_z(turn_rad);
  const Pose scan_T_object{rotation, position_mm};
  for (const Vec2 p : layout.target->outline.outer) {
    for (const double z_mm : {-layout.target->thickness_mm, height_max_mm(*layout.target)}) {
      if (!((scan_T_object * Vec3{p.x, p.y, z_mm}).z >= 0.0)) {  // so that NaN is caught too
        throw std::invalid_argument(
            "scene 'tilt': the part would reach under the floor; raise "
            "held_height_mm");
      }
    }
  }
  layout.result.instances.push_back({layout.target, scan_T_object});
}

void build_empty(Layout&) {}

void build_cyl_loose(Layout& layout) {
  constexpr int kCylinderCount = 12;
  layout.place_or_throw(layout.target);
  for (int i = 1; i < kCylinderCount; ++i) {
    if (!layout.place(layout.target)) break;
  }
}

struct Entry {
  const char* name;
  const char* default_part;
  void (*build)(Layout&);
};

// Heaped scenes come in here: their builders drop parts one by one on what lies there already.
constexpr Entry kEntries[] = {
    {"single", "pad", build_single}, {"lone", "pad", build_lone},
    {"low", "pad", build_low},       {"tilt", "pad", build_tilt},
    {"empty", "pad", build_empty},   {"cyl_loose", "cylinder", build_cyl_loose},
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
    layout.target = shared_part(config.part.empty() ? entry.default_part : config.part);
    layout.result.part = layout.target->name;
    if (config.bin) add_bin(layout, *config.bin);
    entry.build(layout);
    return std::move(layout.result);
  }
  throw std::invalid_argument("unknown scene '" + config.scene + "'; scenes: " + known);
}

}  // namespace flatpose::sim
