#pragma once
// Simulated scans of catalogue parts with their truth, and the library run on them in memory of its
// own.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/teach/teacher.hpp"
#include "port/sim/simulate.hpp"

namespace flatpose::test {

/// A small field at one point a millimetre, without any fault of the sensor but its sampling.
inline sim::SensorConfig clean_sensor() {
  sim::SensorConfig sensor;
  sensor.columns = 300;
  sensor.rows = 250;
  sensor.field_x_mm = 300.0;
  sensor.field_y_mm = 250.0;
  sensor.laser_noise_mm = 0.0;
  sensor.camera_noise_mm = 0.0;
  sensor.lost_share = 0.0;
  sensor.mixed_share = 0.0;
  sensor.quantisation_mm = 0.0;
  return sensor;
}

/// The same field with all faults: noise, lost and mixed points, quantised ranges.
inline sim::SensorConfig noisy_sensor(double noise_mm) {
  sim::SensorConfig sensor = clean_sensor();
  const sim::SensorConfig usual;
  sensor.laser_noise_mm = noise_mm;
  sensor.camera_noise_mm = 0.3 * noise_mm;
  sensor.lost_share = usual.lost_share;
  sensor.mixed_share = usual.mixed_share;
  sensor.quantisation_mm = usual.quantisation_mm;
  return sensor;
}

inline sim::SimulatedScan simulated(const std::string& scene, const std::string& part,
                                    const sim::SensorConfig& sensor, std::uint64_t seed) {
  sim::SceneConfig config;
  config.scene = scene;
  config.part = part;
  return sim::simulate(config, sensor, seed);
}

inline locate::Limits small_limits() { return {300, 250, 120'000}; }

struct Taught {
  Status status = Status::kNoPart;
  model::Template part;
  teach::TeachReport report;
};

inline Taught taught(const std::vector<teach::TeachScan>& scans,
                     const teach::TeachConfig& config = {},
                     const locate::Limits& limits = small_limits()) {
  std::vector<std::byte> memory(teach::Teacher::required_bytes(limits));
  teach::Teacher teacher;
  Taught out;
  EXPECT_EQ(teacher.init(limits, memory), Status::kOk);
  out.status = teacher.teach(scans, config, out.part, out.report);
  return out;
}

inline teach::TeachScan teach_scan(const sim::SimulatedScan& scan) {
  return {scan.view(), frames_of_scan(true)};
}

/// Memory and a locator in it.
struct Locating {
  std::vector<std::byte> memory;
  locate::Locator locator;
  locate::LocateResult result;

  explicit Locating(const locate::Limits& limits = small_limits())
      : memory(locate::Locator::required_bytes(limits)) {
    EXPECT_EQ(locator.init(limits, memory), Status::kOk);
  }
  Status run(const model::Template& part, const RangeImageView& scan,
             const locate::LocateConfig& config = {}, const Host& host = StoppedClock{}) {
    return locator.locate(part, scan, frames_of_scan(true), config, host, result);
  }
};

/// How far a found pose is from the truth. The taught frame is not the simulator's: what lies
/// between the two is known from the teach scan.
struct PoseError {
  double in_plane_mm = 0.0;
  double z_mm = 0.0;
  double tilt_deg = 0.0;
  double turn_deg = 0.0;
};

inline PoseError pose_error(const Pose& found_scan_T_part, const Pose& true_scan_T_part) {
  const Pose d = true_scan_T_part.inverse() * found_scan_T_part;
  PoseError e;
  e.in_plane_mm = std::sqrt(d.position_mm.x * d.position_mm.x + d.position_mm.y * d.position_mm.y);
  e.z_mm = std::fabs(d.position_mm.z);
  e.tilt_deg = arc_cosine(d.rotation.m[8]) * kDegPerRad;
  e.turn_deg = std::fabs(arc_tangent(d.rotation.m[3], d.rotation.m[0])) * kDegPerRad;
  return e;
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}
inline double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

}  // namespace flatpose::test
