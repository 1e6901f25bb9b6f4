#pragma once
// Scenes by name: which parts lie where.
//
//   single     one part flat on the floor at a random place and turn
//   lone       two of the part, apart
//   low        one of the part and three others, apart
//   tilt       one part held in the air at a given tilt
//   empty      the floor
//   cyl_loose  up to twelve standing cylinders, apart
//   cyl_grid   35 touching cylinders in rows and columns, turned and shifted a little
//   cyl_brick  the same with every other row half a pitch aside
//   medium     two of the part and seven others, some on others
//   high       two of the part among 18 to 22 others, more on top
//   pile       18 to 22 of the part, heaped
//   absent     as medium or high, but of the part only two on their faces, one of them at least
//              60 % visible; for the pad and its look-alike also two of the other. A part that is
//              the same from below is left out.
//   steep      one of the part, leaning 20 to 45 degrees on a stack in clutter
//   buried     one of the part in clutter, 50 to 80 % visible under others
//
// In all but empty, tilt, absent and buried one of the part is at least 60 % visible. Parts that
// lie on others rest on three contacts (settle.hpp) and lean 25 degrees at most, but in steep.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flatpose/geometry/pose.hpp"
#include "port/sim/part.hpp"
#include "port/sim/sensor.hpp"

namespace flatpose::sim {

/// Four walls on the floor about the field's middle.
struct Bin {
  double inner_x_mm = 560.0;
  double inner_y_mm = 460.0;
  double height_mm = 80.0;
  double wall_mm = 5.0;
};

struct SceneConfig {
  std::string scene = "single";
  std::string part;         ///< Of the catalogue; empty: the scene's own (pad, cylinder).
  std::optional<Bin> bin;   ///< None: the floor only.
  double tilt_x_rad = 0.0;  ///< `tilt` only: the top's normal is R_x(tilt_x) R_y(tilt_y) z.
  double tilt_y_rad = 0.0;
  std::optional<double> turn_rad;  ///< `tilt` and `single`: object x against scan x; none: random.
  double held_height_mm = 120.0;   ///< `tilt` only: of the origin over the floor.
};

struct Instance {
  std::shared_ptr<const Part> part;
  Pose scan_T_object;
};

struct Scene {
  std::string name;
  std::string part;                 ///< The target's name. Those of it lie first in the list.
  std::vector<Instance> instances;  ///< Parts, which the truth lists.
  std::vector<Instance> fixtures;   ///< What hides and is seen but is no part: bin walls.
};

[[nodiscard]] const std::vector<std::string>& scene_names();

/// The scene in the sensor's field; the same for the same seed.  Cost: 0.1 s for a heap.
/// Fails: std::invalid_argument for an unknown scene (listing the names), an unknown part or a bad
/// bin; std::runtime_error when the parts find no room.
[[nodiscard]] Scene make_scene(const SceneConfig& config, const SensorConfig& sensor,
                               std::uint64_t seed);

}  // namespace flatpose::sim
