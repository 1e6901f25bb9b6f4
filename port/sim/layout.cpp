#include "port/sim/layout.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace flatpose::sim {
namespace {

constexpr int kPlacesTriedMax = 10000;
constexpr double kGapMm = 10.0;  // between parts, and to the field's border or the wall

}  // namespace

Layout::Layout(const SceneConfig& scene, const SensorConfig& sensor, std::uint64_t seed)
    : config(scene), ruler(sensor), random(seed, 0x5CE7E) {
  result.name = config.scene;
}

std::shared_ptr<const Part> Layout::part(const std::string& name) {
  for (const auto& known : parts_) {
    if (known->name == name) return known;
  }
  parts_.push_back(std::make_shared<const Part>(catalogue_part(name)));
  return parts_.back();
}

std::vector<std::string> Layout::other_names() const {
  std::vector<std::string> names = part_names();
  std::erase(names, target->name);
  std::erase(names, "cylinder");
  return names;
}

bool Layout::place(const std::shared_ptr<const Part>& part, std::optional<double> turn_rad) {
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

void Layout::place_or_throw(const std::shared_ptr<const Part>& part,
                            std::optional<double> turn_rad) {
  if (!place(part, turn_rad)) no_room("part '" + part->name + "'");
}

void Layout::no_room(const std::string& what) const {
  throw std::runtime_error("scene '" + config.scene + "': no room for " + what + " in the field");
}

bool Layout::inside(const Instance& instance) const {
  const Part& part = *instance.part;
  const auto& corners = part.outline.outer;
  return std::all_of(corners.begin(), corners.end(), [&](Vec2 p) {
    for (const double z_mm : {-part.thickness_mm, height_max_mm(part)}) {
      const Vec3 p_mm = instance.scan_T_object * Vec3{p.x, p.y, z_mm};
      if (!ruler.in_field(p_mm)) return false;
      if (config.bin && (std::fabs(p_mm.x) > 0.5 * config.bin->inner_x_mm ||
                         std::fabs(p_mm.y) > 0.5 * config.bin->inner_y_mm)) {
        return false;
      }
    }
    return true;
  });
}

bool Layout::has_room(const Vec3& p_mm, double reach_mm, double raised_mm) const {
  for (const double sx : {-reach_mm, reach_mm}) {
    for (const double sy : {-reach_mm, reach_mm}) {
      if (!ruler.in_field(p_mm + Vec3{sx, sy, raised_mm})) return false;
    }
  }
  if (config.bin && (std::fabs(p_mm.x) + reach_mm > 0.5 * config.bin->inner_x_mm ||
                     std::fabs(p_mm.y) + reach_mm > 0.5 * config.bin->inner_y_mm)) {
    return false;
  }
  return std::none_of(result.instances.begin(), result.instances.end(), [&](const Instance& other) {
    const Vec3& q_mm = other.scan_T_object.position_mm;
    const double apart_mm = reach_mm + radius_mm(*other.part);
    const double dx = p_mm.x - q_mm.x;
    const double dy = p_mm.y - q_mm.y;
    return dx * dx + dy * dy < apart_mm * apart_mm;
  });
}

}  // namespace flatpose::sim
