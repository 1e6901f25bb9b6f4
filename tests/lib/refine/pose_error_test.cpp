// How near the whole refinement, solver and last step, comes to the truth on simulated scans.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "flatpose/locate/settings.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/refine/polish.hpp"
#include "flatpose/refine/pose_problem.hpp"
#include "tests/lib/locate/made_scan.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::refine {
namespace {

constexpr int kSeedCount = 10;

struct Lesson {
  model::Template part;
  Pose truth_T_taught;  ///< The taught object frame in the simulator's.
};

Lesson teach(const std::string& name, const sim::SensorConfig& sensor) {
  sim::SceneConfig config;
  config.part = name;
  config.turn_rad = 0.4;  // askew, as one should teach
  const sim::SimulatedScan scan = sim::simulate(config, sensor, 1000);
  test::Taught taught = test::taught({test::teach_scan(scan)});
  EXPECT_EQ(taught.status, Status::kOk) << to_string(taught.status);
  return {taught.part, scan.instances[0].scan_T_object.inverse() * taught.part.scan_T_object};
}

Pose refined(const model::Template& part, const sim::SimulatedScan& scan, const Pose& start) {
  std::vector<std::byte> memory(rectify::survey_required_bytes() + Arena::kAlignmentBytes);
  Arena arena{std::span(memory)};
  const auto survey = rectify::survey(scan.view(), {}, arena);
  EXPECT_TRUE(survey);
  rectify::GridConfig grid_config;
  grid_config.cell_mm = part.cell_mm;
  const auto grid = rectify::choose_grid(*survey, grid_config);
  EXPECT_TRUE(grid);
  const double noise_mm = std::max(survey->noise_sigma_mm, 0.02);
  const test::MadeScene made(scan.view(), *grid, part.pitch_mm, noise_mm);
  const locate::Settings settings =
      locate::derive_settings(part, {}, noise_mm, part.pitch_mm, part.cell_mm);
  const auto wide = minimize<6>(PoseProblem(part, made.fine, settings.wide), start);
  const auto narrow = minimize<6>(PoseProblem(part, made.fine, settings.narrow), wide.x);
  const RawScan raw{scan.view(), {}, &made.scene.map};
  std::vector<std::byte> polish_memory(1'000'000);
  Arena polish_arena{std::span(polish_memory)};
  PolishScratch scratch = take_polish_scratch(polish_arena);
  const auto polished = polish(part, raw, narrow.x, settings.polish, scratch, callers_thread);
  EXPECT_TRUE(polished) << to_string(polished.status());
  return polished->work_T_object;
}

struct Errors {
  std::vector<double> in_plane_mm, z_mm, tilt_deg, turn_deg;
  void add(const test::PoseError& e) {
    in_plane_mm.push_back(e.in_plane_mm);
    z_mm.push_back(e.z_mm);
    tilt_deg.push_back(e.tilt_deg);
    turn_deg.push_back(e.turn_deg);
  }
  void report(const std::string& name) const {
    const struct {
      const char* what;
      const std::vector<double>& values;
    } rows[] = {{"in plane mm", in_plane_mm},
                {"z mm", z_mm},
                {"tilt deg", tilt_deg},
                {"turn deg", turn_deg}};
    for (const auto& row : rows) {
      std::printf("%-24s %-12s median %.4f max %.4f\n", name.c_str(), row.what,
                  test::median(row.values), test::largest(row.values));
    }
  }
};

Errors errors_on(const std::string& scene, const std::string& part, double noise_mm) {
  const sim::SensorConfig sensor =
      noise_mm > 0.0 ? test::noisy_sensor(noise_mm) : test::clean_sensor();
  const Lesson lesson = teach(part, sensor);
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Errors errors;
  for (int seed = 1; seed <= kSeedCount; ++seed) {
    sim::SceneConfig config;
    config.scene = scene;
    config.part = part;
    if (scene == "tilt") {
      config.tilt_x_rad = 0.3 * u(generator);
      config.tilt_y_rad = 0.3 * u(generator);
      config.held_height_mm = 60.0;
    }
    const sim::SimulatedScan scan = sim::simulate(config, sensor, static_cast<std::uint64_t>(seed));
    const Pose truth = scan.instances[0].scan_T_object;
    Vector<6> step;  // as a grid search would leave it
    step << 0.04 * u(generator), 0.04 * u(generator), 0.06 * u(generator), 2.0 * u(generator),
        2.0 * u(generator), 0.5 * u(generator);
    const Pose found = refined(lesson.part, scan, moved(truth * lesson.truth_T_taught, step));
    errors.add(test::pose_error(found * lesson.truth_T_taught.inverse(), truth));
  }
  errors.report(scene + " " + part + " noise " + std::to_string(noise_mm).substr(0, 3));
  return errors;
}

void expect_below(const Errors& errors, double in_plane_mm, double z_mm, double tilt_deg,
                  double turn_deg) {
  EXPECT_LT(test::largest(errors.in_plane_mm), in_plane_mm);
  EXPECT_LT(test::largest(errors.z_mm), z_mm);
  EXPECT_LT(test::largest(errors.tilt_deg), tilt_deg);
  EXPECT_LT(test::largest(errors.turn_deg), turn_deg);
}

TEST(Refinement, FlatPartsWithoutNoise) {
  expect_below(errors_on("single", "bracket", 0.0), 0.5, 0.05, 0.1, 0.5);
}

TEST(Refinement, FlatPartsInNoise) {
  expect_below(errors_on("single", "bracket", 0.4), 1.0, 0.2, 0.5, 1.0);
}

TEST(Refinement, TiltedPartsWithoutNoise) {
  expect_below(errors_on("tilt", "pad", 0.0), 1.0, 0.3, 0.3, 1.0);
}

TEST(Refinement, TiltedPartsInNoise) {
  expect_below(errors_on("tilt", "pad", 0.4), 1.0, 0.3, 0.5, 1.0);
}

}  // namespace
}  // namespace flatpose::refine
