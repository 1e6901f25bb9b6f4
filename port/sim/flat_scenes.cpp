// Scenes whose parts lie apart from each other, flat on the floor or held in the air.

#include <stdexcept>

#include "port/sim/layout.hpp"

namespace flatpose::sim {
namespace {

/// `count` of what lies about the target, none twice.
std::vector<std::shared_ptr<const Part>> others(Layout& layout, int count) {
  std::vector<std::string> names = layout.other_names();
  std::vector<std::shared_ptr<const Part>> drawn;
  for (int i = 0; i < count; ++i) {
    const int pick = layout.random.index(static_cast<int>(names.size()));
    drawn.push_back(layout.part(names[pick]));
    names.erase(names.begin() + pick);
  }
  return drawn;
}

}  // namespace

void build_single(Layout& layout) { layout.place_or_throw(layout.target, layout.config.turn_rad); }

void build_lone(Layout& layout) {
  for (int i = 0; i < 2; ++i) layout.place_or_throw(layout.target);
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

}  // namespace flatpose::sim
