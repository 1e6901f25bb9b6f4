#pragma once
// Boxes: what shadows and shares are worked out for by hand.

#include <memory>
#include <utility>

#include "port/sim/scene.hpp"
#include "port/sim/sensor.hpp"

namespace flatpose::sim {

/// A box whose top is centred at `top_mm`, edges along the axes.
inline Instance box(Vec3 top_mm, double size_x_mm, double size_y_mm, double height_mm) {
  Part part{.name = "box", .outline = {}, .thickness_mm = height_mm, .areas = {}};
  part.outline.outer = rectangle({}, size_x_mm, size_y_mm);
  return {std::make_shared<const Part>(make_part(std::move(part))), {Rotation{}, top_mm}};
}

inline Scene scene_of(std::vector<Instance> instances) {
  Scene scene;
  scene.name = "by hand";
  scene.instances = std::move(instances);
  return scene;
}

/// A sensor that measures what is there.
inline SensorConfig exact_sensor() {
  SensorConfig config;
  config.laser_noise_mm = 0.0;
  config.camera_noise_mm = 0.0;
  config.lost_share = 0.0;
  config.mixed_share = 0.0;
  config.quantisation_mm = 0.0;
  return config;
}

}  // namespace flatpose::sim
