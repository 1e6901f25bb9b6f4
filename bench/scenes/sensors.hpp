#pragma once
// Sensors by name: the simulator's default and what makes scans worse.
//
//   standard   600 x 500 points over 600 x 500 mm, noise 0.4 mm, 1 % lost
//   noise      1 mm along the laser ray, 0.3 mm along the camera ray
//   lost       20 % of the points
//   half       300 x 250 points over the same field

#include <string>
#include <vector>

#include "port/sim/sensor.hpp"

namespace flatpose::bench {

[[nodiscard]] const std::vector<std::string>& sensor_names();
/// Fails: std::invalid_argument that lists the names.
[[nodiscard]] sim::SensorConfig sensor_named(const std::string& name);

}  // namespace flatpose::bench
