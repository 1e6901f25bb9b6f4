// flatpose simulate SCENE --seed N -o SCAN.pcd --truth TRUTH.json

#include <array>
#include <memory>
#include <stdexcept>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/pcd.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/output_file.hpp"
#include "port/linux/tool/pose_json.hpp"
#include "port/sim/simulate.hpp"

namespace flatpose::tool {
namespace {

// Shares of the noise along laser and camera, as the sensor has them by default.
constexpr double kCameraNoiseShare = 0.3;
constexpr int kSideMax = 32767;
constexpr double kFieldMax_mm = 100'000.0;
constexpr double kTiltMax_deg = 80.0;

struct Options {
  std::string scan_path;
  std::string truth_path;
  sim::SceneConfig scene;
  sim::SensorConfig sensor;
  std::uint64_t seed = 0;
  double noise_mm = -1.0;
  double tilt_x_deg = 0.0;
  double tilt_y_deg = 0.0;
};

std::string truth_text(const sim::SimulatedScan& scan) {
  Json json;
  json["scene"] = scan.scene;
  json["seed"] = scan.seed;
  json["part"] = scan.part;
  json["instances"] = Json::array();
  for (const sim::SimulatedInstance& instance : scan.instances) {
    json["instances"].push_back({{"part", instance.part},
                                 {"position_mm", json_of(instance.scan_T_object.position_mm)},
                                 {"rotation", instance.scan_T_object.rotation.m},
                                 {"visible", instance.visible}});
  }
  return json.dump(1) + "\n";
}

sim::SimulatedScan simulate(const Options& options) {
  sim::SensorConfig sensor = options.sensor;
  if (options.noise_mm >= 0.0) {
    sensor.laser_noise_mm = options.noise_mm;
    sensor.camera_noise_mm = kCameraNoiseShare * options.noise_mm;
  }
  sim::SceneConfig scene = options.scene;
  scene.tilt_x_rad = options.tilt_x_deg * kRadPerDeg;
  scene.tilt_y_rad = options.tilt_y_deg * kRadPerDeg;
  try {
    return sim::simulate(scene, sensor, options.seed);
  } catch (const std::invalid_argument& error) {
    throw port::InputError("simulate", error.what(), "see flatpose simulate --help");
  } catch (const std::runtime_error& error) {
    throw port::InputError("simulate", error.what(), "enlarge the field or take another seed");
  }
}

ExitCode run(const Options& options, Report& report) {
  check_outputs({}, std::array{options.scan_path, options.truth_path});
  const sim::SimulatedScan scan = simulate(options);
  FirstOutput output(options.scan_path);
  port::write_pcd(options.scan_path, scan.view(), scan.viewpoint_mm, true);
  if (!options.truth_path.empty())
    port::write_file_atomically(options.truth_path, truth_text(scan));
  output.keep();
  report.text = formatted("simulated scene '%s', seed %llu: %d x %d points, %zu parts\n",
                          scan.scene.c_str(), static_cast<unsigned long long>(scan.seed),
                          scan.width_px, scan.height_px, scan.instances.size());
  return ExitCode::kDone;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Action add_simulate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  Options& o = *options;
  app.add_option("SCENE", o.scene.scene, joined(sim::scene_names()))->required();
  add_text(app, "--seed", "N", "the same seed makes the same scan", [&o](const std::string& text) {
    o.seed = parse_seed("--seed", text);
  })->required();
  app.add_option("-o,--output", o.scan_path, "the scan")->type_name("SCAN.pcd")->required();
  app.add_option("--truth", o.truth_path, "the parts' poses")->type_name("TRUTH.json");
  app.add_option("--part", o.scene.part, joined(sim::part_names()))->type_name("NAME");
  add_count(app, "--cols", "N", "points along x (600)", o.sensor.columns, 2, kSideMax);
  add_count(app, "--rows", "N", "points along y (500)", o.sensor.rows, 2, kSideMax);
  add_number(app, "--field-x-mm", "MM", "width of the field (600)", o.sensor.field_x_mm, 1.0,
             kFieldMax_mm);
  add_number(app, "--field-y-mm", "MM", "depth of the field (500)", o.sensor.field_y_mm, 1.0,
             kFieldMax_mm);
  add_number(app, "--noise-mm", "MM", "sigma along the laser; camera 0.3 of it (0.4)", o.noise_mm,
             0.0, 100.0);
  add_number(app, "--lost", "SHARE", "points lost at random, 0 to 1 (0.01)", o.sensor.lost_share,
             0.0, 1.0);
  add_number(app, "--tilt-x", "DEG", "of the part in scene `tilt`", o.tilt_x_deg, -kTiltMax_deg,
             kTiltMax_deg);
  add_number(app, "--tilt-y", "DEG", "of the part in scene `tilt`", o.tilt_y_deg, -kTiltMax_deg,
             kTiltMax_deg);
  add_text(app, "--turn", "DEG", "of the part in scenes `tilt` and `single` (random)",
           [&o](const std::string& text) {
             o.scene.turn_rad = parse_number("--turn", text, -360.0, 360.0) * kRadPerDeg;
           });
  return [options](Report& report) { return run(*options, report); };
}

}  // namespace flatpose::tool
