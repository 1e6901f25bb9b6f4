#pragma once
// From a scene to a range image with its truth. Scene, sensor and seed determine every bit of it.

#include <cstdint>
#include <string>
#include <vector>

#include "flatpose/geometry/range_image.hpp"
#include "port/sim/scene.hpp"
#include "port/sim/sensor.hpp"

namespace flatpose::sim {

struct SimulatedInstance {
  std::string part;
  Pose scan_T_object;
  double visible = 0.0;  ///< Share of the top (areas counted in) that laser and camera both see.
};

struct SimulatedScan {
  int width_px = 0;           ///< Columns.
  int height_px = 0;          ///< Rows.
  std::vector<float> xyz_mm;  ///< x, y, z of a pixel side by side, row by row; NaN where missing.
  Vec3 viewpoint_mm;          ///< The camera.  Frames: scan; z > 0, so up is +z.
  std::string scene;
  std::string part;
  std::uint64_t seed = 0;
  std::vector<SimulatedInstance> instances;

  /// Valid as long as the scan is neither moved from nor destroyed.
  [[nodiscard]] RangeImageView view() const noexcept;
};

/// Scans a scene of the catalogue.
/// Cost: about 0.3 us a point and body in its way.  Fails: as make_scene() and Ruler.
[[nodiscard]] SimulatedScan simulate(const SceneConfig& scene, const SensorConfig& sensor,
                                     std::uint64_t seed);

/// Scans a scene of the caller's own making; the seed rules the noise.
[[nodiscard]] SimulatedScan scan(const Scene& scene, const SensorConfig& sensor,
                                 std::uint64_t seed);

}  // namespace flatpose::sim
