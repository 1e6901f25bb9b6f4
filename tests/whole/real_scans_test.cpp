// The whole way on scans by a real laser-triangulation camera: taught in one place, found in
// another.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/teach/teacher.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose {
namespace {

std::filesystem::path data_folder() {
  const char* folder = std::getenv("FLATPOSE_REAL_DATA");
  return folder != nullptr ? folder : FLATPOSE_REAL_DATA_DEFAULT;
}

class RealScans : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::is_directory(data_folder())) return;
    const char* ci = std::getenv("CI");
    ASSERT_FALSE(ci != nullptr && std::string(ci) == "true")
        << "no real scans in " << data_folder();
    GTEST_SKIP() << "no real scans in " << data_folder();
  }

  port::Scan read(const std::string& name) { return port::read_scan(data_folder() / name); }

  model::Template teach(const port::Scan& scan, const Region& region, int symmetry_order = 1) {
    teach::Teacher teacher;
    memory_.resize(teach::Teacher::required_bytes(limits_));
    EXPECT_EQ(teacher.init(limits_, memory_), Status::kOk);
    teach::TeachConfig config;
    config.name = {'p', 'a', 'r', 't'};
    config.region = region;
    config.symmetry_order = symmetry_order;
    config.up = -1;
    model::Template part;
    teach::TeachReport report;
    const teach::TeachScan source{scan.view(), frames_of_scan(scan.up == port::Up::kPlusZ)};
    EXPECT_EQ(teacher.teach({&source, 1}, config, part, report), Status::kOk);
    return part;
  }

  locate::LocateResult locate(const model::Template& part, const port::Scan& scan,
                              int max_matches) {
    locate::Locator locator;
    EXPECT_EQ(locator.init(limits_, memory_), Status::kOk);
    locate::LocateConfig config;
    config.max_matches = max_matches;
    locate::LocateResult result;
    EXPECT_EQ(locator.locate(part, scan.view(), frames_of_scan(scan.up == port::Up::kPlusZ), config,
                             StoppedClock{}, result),
              Status::kOk);
    return result;
  }

 private:
  locate::Limits limits_{.scan_width_px = 800, .scan_height_px = 800, .cell_count = 1'000'000};
  std::vector<std::byte> memory_;
};

Region circle(double x_mm, double y_mm, double radius_mm) {
  Region region;
  region.kind = Region::Kind::kCircle;
  region.x_mm = x_mm;
  region.y_mm = y_mm;
  region.radius_mm = radius_mm;
  return region;
}

Region box(double x_mm, double y_mm, double half_x_mm, double half_y_mm) {
  Region region;
  region.kind = Region::Kind::kBox;
  region.vertex_count = 2;
  region.vertex_x_mm = {x_mm - half_x_mm, x_mm + half_x_mm};
  region.vertex_y_mm = {y_mm - half_y_mm, y_mm + half_y_mm};
  return region;
}

Vec3 vec3(const nlohmann::json& j) { return {j[0], j[1], j[2]}; }

double turn_deg(const Rotation& r) { return arc_tangent(r.m[3], r.m[0]) * kDegPerRad; }

TEST_F(RealScans, DiscIsFoundWithinTheReferenceTolerance) {
  const nlohmann::json reference =
      nlohmann::json::parse(std::ifstream(data_folder() / "sick_disc/reference_pose.json"));
  Pose match_T_teach;
  for (int i = 0; i < 9; ++i) {
    match_T_teach.rotation.m[i] = reference["T_match_from_teach"]["R"][i / 3][i % 3];
  }
  match_T_teach.position_mm = vec3(reference["T_match_from_teach"]["t_mm"]);

  const model::Template part = teach(read("sick_disc/disc_teach.pcd"), circle(-4.0, 77.2, 66.0));
  const locate::LocateResult result = locate(part, read("sick_disc/disc_match.pcd"), 1);
  ASSERT_EQ(result.match_count, 1);
  const Pose found = result.matches[0].face_T_object * part.scan_T_object.inverse();

  const Vec3 centre_mm = vec3(reference["disc_centre_on_plate_teach_mm"]);
  const Vec3 off_mm = found * centre_mm - match_T_teach * centre_mm;
  const Vec3 normal = vec3(reference["plate_normal_teach"]);
  const double tilt_rad = norm(cross(found.rotation * normal, match_T_teach.rotation * normal));
  const double yaw_deg =
      wrap_angle((turn_deg(found.rotation) - turn_deg(match_T_teach.rotation)) * kRadPerDeg) *
      kDegPerRad;
  const nlohmann::json& tolerance = reference["tolerance"];
  EXPECT_LE(std::hypot(off_mm.x, off_mm.y), tolerance["in_plane_mm"].get<double>());
  EXPECT_LE(std::fabs(off_mm.z), tolerance["z_mm"].get<double>());
  EXPECT_LE(std::fabs(yaw_deg), tolerance["yaw_deg"].get<double>());
  EXPECT_LE(tilt_rad * kDegPerRad, tolerance["tilt_deg"].get<double>());
  RecordProperty("off_mm", std::to_string(off_mm.x) + " " + std::to_string(off_mm.y) + " " +
                               std::to_string(off_mm.z));
  std::printf(
      "disc against the reference: in plane %.3f mm, z %.4f mm, yaw %.3f deg, tilt %.3f deg\n",
      std::hypot(off_mm.x, off_mm.y), off_mm.z, yaw_deg, tilt_rad * kDegPerRad);
}

/// A place in sick_shapes by its pixel.
Vec3 place(double column, double row) { return {-73.94 + 0.21585 * column, 0.20882 * row, 0.0}; }

double distance_in_plane_mm(const Vec3& a, const Vec3& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

struct Bar {
  Vec3 centre_mm;
  double turn_deg;
};

const std::vector<Bar>& bars() {
  static const std::vector<Bar> all{{place(244, 116), 0.0},
                                    {place(230, 177), 23.0},
                                    {place(196, 233), 45.5},
                                    {place(143, 269), 67.7},
                                    {place(85, 284), 89.5}};
  return all;
}

/// A rectangle around a bar of 31 x 5.7 mm, with a margin.
Region around(const Bar& bar) {
  constexpr double kHalfLength_mm = 17.0;
  constexpr double kHalfWidth_mm = 4.3;
  const auto [s, c] = sin_cos(bar.turn_deg * kRadPerDeg);
  Region region;
  region.kind = Region::Kind::kPolygon;
  for (const auto& [along, across] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double u_mm = along * kHalfLength_mm;
    const double v_mm = across * kHalfWidth_mm;
    region.vertex_x_mm[static_cast<std::size_t>(region.vertex_count)] =
        bar.centre_mm.x + c * u_mm - s * v_mm;
    region.vertex_y_mm[static_cast<std::size_t>(region.vertex_count)] =
        bar.centre_mm.y + s * u_mm + c * v_mm;
    ++region.vertex_count;
  }
  return region;
}

class RealBars : public RealScans, public ::testing::WithParamInterface<int> {};

TEST_P(RealBars, TaughtFromOneFindsAllFiveAndNothingElse) {
  const port::Scan scan = read("sick_shapes/shapes.pcd");
  const model::Template part = teach(scan, around(bars()[static_cast<std::size_t>(GetParam())]), 2);
  const locate::LocateResult result = locate(part, scan, 20);
  EXPECT_EQ(result.match_count, 5);
  for (const Bar& bar : bars()) {
    int count = 0;
    for (const locate::Match& match : result.found()) {
      const double off_mm = distance_in_plane_mm(match.face_T_object.position_mm, bar.centre_mm);
      if (off_mm > 1.0) continue;
      ++count;
      const double off_deg =
          std::remainder(turn_deg(match.face_T_object.rotation) - bar.turn_deg, 180.0);
      // Taught at an angle, the bar's own x is the scan's.
      const double taught_deg =
          std::remainder(off_deg + bars()[static_cast<std::size_t>(GetParam())].turn_deg, 180.0);
      EXPECT_LE(std::fabs(taught_deg), 1.5) << "bar at " << bar.turn_deg;
      std::printf("bar at %.1f deg: off %.3f mm, %.2f deg, score %.3f\n", bar.turn_deg, off_mm,
                  taught_deg, match.score);
    }
    EXPECT_EQ(count, 1) << "bar at " << bar.turn_deg;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, RealBars, ::testing::Range(0, 5));

class RealPlates : public RealScans, public ::testing::WithParamInterface<int> {};

TEST_P(RealPlates, IsFoundOnlyWhereItIs) {
  const std::vector<Vec3> plates{place(431, 127), place(620, 128), place(430, 327),
                                 place(621, 329)};
  const Vec3 centre_mm = plates[static_cast<std::size_t>(GetParam())];
  const port::Scan scan = read("sick_shapes/shapes.pcd");
  const model::Template part = teach(scan, box(centre_mm.x, centre_mm.y, 19.5, 19.5));
  const locate::LocateResult result = locate(part, scan, 20);
  ASSERT_EQ(result.match_count, 1);
  const Vec3 found_mm = result.matches[0].face_T_object.position_mm;
  // The plate's own origin is the centroid of its surface, up to 2 mm off the middle of its
  // outline.
  EXPECT_LE(distance_in_plane_mm(found_mm, centre_mm), 2.0);
  EXPECT_GE(result.matches[0].score, result.best_rejected_score + 0.1);
  std::printf("plate %d: score %.3f, threshold %.3f, best of what was rejected %.3f\n", GetParam(),
              result.matches[0].score, part.score_threshold, result.best_rejected_score);
}

INSTANTIATE_TEST_SUITE_P(Shapes, RealPlates, ::testing::Range(0, 4));

}  // namespace
}  // namespace flatpose
