#pragma once
// Small parts in a small field, so that hundreds of simulated scans are cheap, and shots of them
// whose pose is drawn by lot.

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tests/lib/locate/simulated.hpp"

namespace flatpose::test {

using SharedPart = std::shared_ptr<const sim::Part>;

inline SharedPart made(sim::Part part, sim::Loop outer) {
  part.outline.outer = std::move(outer);
  return std::make_shared<const sim::Part>(sim::make_part(std::move(part)));
}

/// 48 x 34, looks like itself in one turn only.
inline SharedPart small_ell() {
  const sim::Vec2 corners[] = {{0, 0}, {48, 0}, {48, 18}, {18, 18}, {18, 34}, {0, 34}};
  return made({.name = "ell", .outline = {}, .thickness_mm = 6.0, .areas = {}},
              sim::rounded_polygon(corners, 2.0));
}
inline SharedPart small_disc() {
  return made({.name = "disc", .outline = {}, .thickness_mm = 6.0, .areas = {}, .symmetry_fold = 0},
              sim::circle({}, 20.0));
}

inline sim::SensorConfig small_sensor(double noise_mm) {
  sim::SensorConfig sensor = noisy_sensor(noise_mm);
  sensor.columns = 110;
  sensor.rows = 100;
  sensor.field_x_mm = 110.0;
  sensor.field_y_mm = 100.0;
  return sensor;
}

inline locate::Limits small_field_limits() { return {110, 100, 40'000}; }

/// Near the middle, in any turn, leaning by up to 6 degrees about either axis.
inline Pose pose_by_lot(const sim::Part& part, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const auto within = [&](double reach) {
    return reach * (2.0 * static_cast<double>(generator() >> 11) * 0x1p-53 - 1.0);
  };
  const double lean_x_rad = within(0.1);
  const double lean_y_rad = within(0.1);
  const double turn_rad = within(kPi);
  const double x_mm = within(10.0);
  const double y_mm = within(10.0);
  return {rotation_from_vector({lean_x_rad, lean_y_rad, 0.0}) * rotation_about_z(turn_rad),
          {x_mm, y_mm, part.thickness_mm + 4.0}};
}

inline sim::SimulatedScan shot(const SharedPart& part, const Pose& scan_T_object,
                               const sim::SensorConfig& sensor, std::uint64_t seed,
                               const std::vector<sim::Instance>& covers = {}) {
  sim::Scene scene;
  scene.name = "made";
  scene.part = part->name;
  scene.instances.push_back({part, scan_T_object});
  scene.fixtures = covers;
  return sim::scan(scene, sensor, seed);
}

struct Lesson {
  model::Template part;
  Pose object_T_part;  ///< To the frame that was taught, by the first teach scan.
};

/// Taught as users do, by three scans with the sensor that will look for it.
inline Lesson lesson(const SharedPart& part, const sim::SensorConfig& sensor) {
  std::vector<sim::SimulatedScan> scans;
  for (const std::uint64_t seed : {9000U, 9001U, 9002U}) {
    Pose level = pose_by_lot(*part, seed);
    const Vec3 x = level.rotation.column(0);
    level.rotation = rotation_about_z(arc_tangent(x.y, x.x));
    level.position_mm.z = part->thickness_mm;
    scans.push_back(shot(part, level, sensor, seed));
  }
  std::vector<teach::TeachScan> teach_scans;
  for (const sim::SimulatedScan& scan : scans) teach_scans.push_back(teach_scan(scan));
  teach::TeachConfig config;
  config.symmetry_order = part->symmetry_fold;
  const Taught result = taught(teach_scans, config, small_field_limits());
  EXPECT_EQ(result.status, Status::kOk) << to_string(result.status);
  return {result.part,
          result.part.scan_T_object.inverse() * scans.front().instances.front().scan_T_object};
}

}  // namespace flatpose::test
