// Teaching from simulated scans, held against the simulator's own outlines.

#include "flatpose/teach/teacher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "flatpose/model/template_file.hpp"
#include "tests/lib/locate/allocation_guard.hpp"
#include "tests/lib/locate/made_bin.hpp"
#include "tests/lib/locate/simulated.hpp"

namespace flatpose::teach {
namespace {

using test::MadeScan;
using test::Taught;

sim::SimulatedScan single(const std::string& part, const sim::SensorConfig& sensor,
                          std::uint64_t seed, double turn_rad) {
  sim::SceneConfig config;
  config.part = part;
  config.turn_rad = turn_rad;
  return sim::simulate(config, sensor, seed);
}

/// Distance to an outline's border, positive outside.
double distance_to(const sim::Loop& loop, sim::Vec2 p) {
  double best2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const sim::Vec2 a = loop[i];
    const sim::Vec2 d = loop[(i + 1) % loop.size()] - a;
    const sim::Vec2 ap = p - a;
    const double s = std::clamp((ap.x * d.x + ap.y * d.y) / (d.x * d.x + d.y * d.y), 0.0, 1.0);
    const sim::Vec2 off = ap - s * d;
    best2 = std::min(best2, off.x * off.x + off.y * off.y);
  }
  return std::sqrt(best2);
}

double signed_distance_mm(const sim::Part& part, sim::Vec2 p) {
  double best = distance_to(part.outline.outer, p);
  for (const sim::Loop& hole : part.outline.holes) best = std::min(best, distance_to(hole, p));
  return sim::contains(part, p) ? -best : best;
}

struct ContourError {
  double rms_mm = 0.0;
  double mean_mm = 0.0;
  double largest_mm = 0.0;
  int measured_count = 0;
};

/// Of the points that the scan's own lines placed: against the true outline, in the part's frame.
ContourError contour_error(const model::Template& part, const Pose& truth_T_taught,
                           const sim::Part& drawn) {
  ContourError e;
  for (const model::ContourPoint& c : part.contour_points()) {
    if (c.spread_mm < 0.0F) continue;
    const Vec3 p = truth_T_taught * Vec3{c.x_mm, c.y_mm, c.z_mm};
    const double d = signed_distance_mm(drawn, {p.x, p.y});
    e.rms_mm += d * d;
    e.mean_mm += d;
    e.largest_mm = std::max(e.largest_mm, std::fabs(d));
    ++e.measured_count;
  }
  e.rms_mm = std::sqrt(e.rms_mm / std::max(1, e.measured_count));
  e.mean_mm /= std::max(1, e.measured_count);
  return e;
}

Pose truth_T_taught(const sim::SimulatedScan& scan, const model::Template& part) {
  return scan.instances[0].scan_T_object.inverse() * part.scan_T_object;
}

TEST(Teacher, ContourLiesOnTheTrueOutline) {
  for (const char* name : {"bracket", "washer"}) {
    const auto scan = single(name, test::clean_sensor(), 3, 0.4);
    const Taught t = test::taught({test::teach_scan(scan)});
    ASSERT_EQ(t.status, Status::kOk) << name << ": " << to_string(t.status);
    const ContourError e =
        contour_error(t.part, truth_T_taught(scan, t.part), sim::catalogue_part(name));
    std::printf("%-8s contour: rms %.3f mean %+.3f largest %.3f mm, %d points\n", name, e.rms_mm,
                e.mean_mm, e.largest_mm, e.measured_count);
    EXPECT_GT(e.measured_count, t.part.contour_count / 2) << name;
    EXPECT_LT(e.rms_mm, 0.35) << name;  // of a pitch of one
    EXPECT_LT(std::fabs(e.mean_mm), 0.15) << name;
    EXPECT_LT(e.largest_mm, 1.5) << name;
  }
}

TEST(Teacher, CloudsAndFrameAreOfThePart) {
  const sim::Part drawn = sim::catalogue_part("bracket");
  const auto scan = single("bracket", test::clean_sensor(), 3, 0.4);
  const Taught t = test::taught({test::teach_scan(scan)});
  ASSERT_EQ(t.status, Status::kOk);
  EXPECT_TRUE(model::is_valid(t.part));
  const Pose to_truth = truth_T_taught(scan, t.part);
  for (const model::SurfacePoint& s : t.part.surface_points()) {
    const Vec3 p = to_truth * Vec3{s.x_mm, s.y_mm, s.z_mm};
    EXPECT_LT(signed_distance_mm(drawn, {p.x, p.y}), 0.0);
    EXPECT_NEAR(p.z, 0.0, 0.05);
  }
  for (const model::ContourPoint& c : t.part.contour_points()) {
    EXPECT_NEAR(c.nx * c.nx + c.ny * c.ny, 1.0F, 1e-4F);
    // Outward: a step along the normal leaves the part, a step against it enters.
    const Vec3 out = to_truth * Vec3{c.x_mm + 2.0F * c.nx, c.y_mm + 2.0F * c.ny, 0.0};
    const Vec3 in = to_truth * Vec3{c.x_mm - 2.0F * c.nx, c.y_mm - 2.0F * c.ny, 0.0};
    EXPECT_GT(signed_distance_mm(drawn, {out.x, out.y}), 0.0);
    EXPECT_LT(signed_distance_mm(drawn, {in.x, in.y}), 0.0);
  }
  const model::Anchor& a = t.part.anchors[0];
  const Vec3 p = to_truth * Vec3{a.x_mm, a.y_mm, 0.0};
  EXPECT_LT(signed_distance_mm(drawn, {p.x, p.y}), -0.7 * static_cast<double>(a.clearance_mm));
  EXPECT_NEAR(t.part.area_mm2, sim::area_mm2(drawn), 0.3 * sim::area_mm2(drawn));
  EXPECT_NEAR(t.part.step_mm, drawn.thickness_mm, 0.5);
  EXPECT_NEAR(t.part.pitch_mm, 1.0, 0.05);

  // The frame: centroid of the surface, the scan's x, the surface's normal.
  const Pose& truth = scan.instances[0].scan_T_object;
  const Pose& pose = t.part.scan_T_object;
  // The cells beside a contour are not counted, so that the centroid is near that of the part.
  EXPECT_LT(norm(pose.position_mm - truth.position_mm), 2.0);
  EXPECT_NEAR(pose.position_mm.z, truth.position_mm.z, 0.02);
  EXPECT_GT(pose.rotation.m[0], 0.9999);
  EXPECT_GT(pose.rotation.m[8], 0.9999);
  EXPECT_LT(t.report.flatness_rms_mm, 0.05);
}

TEST(Teacher, FramePointsToASensorBelowToo) {
  // The same part seen along +z: half a turn of the scan about x.
  auto scan = single("washer", test::clean_sensor(), 3, 0.7);
  const Taught above = test::taught({test::teach_scan(scan)});
  for (std::size_t i = 0; i < scan.xyz_mm.size(); i += 3) {
    scan.xyz_mm[i + 1] = -scan.xyz_mm[i + 1];
    scan.xyz_mm[i + 2] = -scan.xyz_mm[i + 2];
  }
  TeachConfig config;
  config.up = -1;
  const Taught below = test::taught({{scan.view(), frames_of_scan(false)}}, config);
  ASSERT_EQ(above.status, Status::kOk);
  ASSERT_EQ(below.status, Status::kOk);
  EXPECT_EQ(below.part.up, -1);
  const Pose& p = above.part.scan_T_object;
  const Pose& q = below.part.scan_T_object;
  EXPECT_NEAR(q.position_mm.x, p.position_mm.x, 1e-3);
  EXPECT_NEAR(q.position_mm.y, -p.position_mm.y, 1e-3);
  EXPECT_NEAR(q.position_mm.z, -p.position_mm.z, 1e-3);
  EXPECT_LT(q.rotation.m[8], -0.9999);
  EXPECT_GT(q.rotation.m[0], 0.9999);
}

TEST(Teacher, ALeaningPartIsFlatInItsOwnFrame) {
  const Pose leaning{rotation_from_vector({0.1, 0.25, 0.0}) * rotation_about_z(0.3),
                     {75.0, 60.0, 30.0}};
  const MadeScan scan = test::bin_scan({{leaning}}, 0.02);
  const Taught t = test::taught({{scan.view(), frames_of_scan(true)}});
  ASSERT_EQ(t.status, Status::kOk) << to_string(t.status);
  const Vec3 z = t.part.scan_T_object.rotation.column(2);
  EXPECT_LT(arc_cosine(dot(z, leaning.rotation.column(2))) * kDegPerRad, 0.1);
  for (const model::SurfacePoint& p : t.part.surface_points()) EXPECT_NEAR(p.z_mm, 0.0F, 0.1F);
  for (const model::ContourPoint& p : t.part.contour_points()) EXPECT_NEAR(p.z_mm, 0.0F, 0.25F);
}

TEST(Teacher, OriginAndXAxisAreWhereTheyAreGiven) {
  const auto scan = single("flange", test::clean_sensor(), 3, 0.3);
  TeachConfig config;
  config.origin = {true, 12.5, -31.25};  // beside the part as well
  config.x_axis = {true, -1.0, 2.0};
  const Taught t = test::taught({test::teach_scan(scan)}, config);
  ASSERT_EQ(t.status, Status::kOk);
  const Pose& pose = t.part.scan_T_object;
  EXPECT_NEAR(pose.position_mm.x, 12.5, 1e-6);
  EXPECT_NEAR(pose.position_mm.y, -31.25, 1e-6);
  EXPECT_NEAR(pose.position_mm.z, 10.0, 0.02);
  EXPECT_NEAR(arc_tangent(pose.rotation.m[3], pose.rotation.m[0]), arc_tangent(2.0, -1.0), 1e-3);
}

TEST(Teacher, SymmetricPartHasItsOriginOnTheAxis) {
  const auto scan = single("flange", test::clean_sensor(), 3, 0.3);
  const Vec3& truth_mm = scan.instances[0].scan_T_object.position_mm;
  TeachConfig config;
  config.symmetry_order = 4;
  const Taught own = test::taught({test::teach_scan(scan)}, config);
  ASSERT_EQ(own.status, Status::kOk);
  EXPECT_NEAR(own.part.scan_T_object.position_mm.x, truth_mm.x, 0.15);
  EXPECT_NEAR(own.part.scan_T_object.position_mm.y, truth_mm.y, 0.15);
  EXPECT_NEAR(own.part.symmetry.center_x_mm, 0.0, 0.1);
  EXPECT_NEAR(own.part.symmetry.center_y_mm, 0.0, 0.1);
  EXPECT_EQ(own.part.weakness & model::kWeakSymmetryLikely, 0U);
  // With an origin beside the axis the axis stays where it is.
  config.origin = {true, truth_mm.x + 20.0, truth_mm.y - 10.0};
  const Taught beside = test::taught({test::teach_scan(scan)}, config);
  ASSERT_EQ(beside.status, Status::kOk);
  EXPECT_NEAR(beside.part.scan_T_object.position_mm.x, truth_mm.x + 20.0, 1e-6);
  EXPECT_NEAR(beside.part.symmetry.center_x_mm, -20.0, 0.2);
  EXPECT_NEAR(beside.part.symmetry.center_y_mm, 10.0, 0.2);
}

TEST(Teacher, SymmetryCenterIsWhereItIsGiven) {
  const auto scan = single("flange", test::clean_sensor(), 3, 0.3);
  const Vec3& truth_mm = scan.instances[0].scan_T_object.position_mm;
  TeachConfig config;
  config.symmetry_order = 4;
  config.symmetry_center = {true, truth_mm.x + 0.2, truth_mm.y};
  const Taught t = test::taught({test::teach_scan(scan)}, config);
  ASSERT_EQ(t.status, Status::kOk);
  EXPECT_NEAR(t.part.scan_T_object.position_mm.x, truth_mm.x + 0.2, 1e-3);
  EXPECT_NEAR(t.part.scan_T_object.position_mm.y, truth_mm.y, 1e-3);
  EXPECT_NEAR(t.part.symmetry.center_x_mm, 0.0, 1e-3);
}

TEST(Teacher, MoreScansComeNearerToTheTruth) {
  const sim::Part drawn = sim::catalogue_part("bracket");
  const sim::SensorConfig sensor = test::noisy_sensor(0.1);
  // The first lies along the grid, where straight edges are off by one common fraction of a pitch.
  std::vector<sim::SimulatedScan> scans;
  const double turns_rad[] = {0.0, 0.5, 1.3};
  for (std::uint64_t i = 0; i < 3; ++i)
    scans.push_back(single("bracket", sensor, 20 + i, turns_rad[i]));
  const Taught one = test::taught({test::teach_scan(scans[0])});
  std::vector<TeachScan> all;
  for (const auto& scan : scans) all.push_back(test::teach_scan(scan));
  const Taught many = test::taught(all);
  ASSERT_EQ(one.status, Status::kOk);
  ASSERT_EQ(many.status, Status::kOk);
  EXPECT_EQ(one.report.scan_count_used, 1);
  EXPECT_EQ(many.report.scan_count_used, 3);
  const ContourError before = contour_error(one.part, truth_T_taught(scans[0], one.part), drawn);
  const ContourError after = contour_error(many.part, truth_T_taught(scans[0], many.part), drawn);
  std::printf("one scan rms %.3f mean %+.3f, three scans rms %.3f mean %+.3f mm\n", before.rms_mm,
              before.mean_mm, after.rms_mm, after.mean_mm);
  EXPECT_LT(after.rms_mm, 0.9 * before.rms_mm);
}

TEST(Teacher, ThresholdLiesBetweenThePartAndItsRivals) {
  for (const char* name : {"pad", "plate"}) {
    const auto scan = single(name, test::noisy_sensor(0.1), 3, 0.4);
    const Taught t = test::taught({test::teach_scan(scan)});
    ASSERT_EQ(t.status, Status::kOk);
    EXPECT_GT(t.part.self_score, 0.9);
    EXPECT_LT(t.part.rival_score, t.part.score_threshold);
    EXPECT_GT(t.part.self_score, t.part.score_threshold);
    EXPECT_EQ(t.part.weakness & model::kWeakMarginThin, 0U);
  }
}

TEST(Teacher, IsRepeatable) {
  const auto scan = single("washer", test::noisy_sensor(0.2), 3, 0.4);
  const Taught a = test::taught({test::teach_scan(scan)});
  const Taught b = test::taught({test::teach_scan(scan)}, {}, {640, 480, 400'000});
  ASSERT_EQ(a.status, Status::kOk);
  ASSERT_EQ(b.status, Status::kOk);
  std::vector<std::byte> bytes_a(model::kTemplateFileBytesMax), bytes_b(bytes_a.size());
  const auto size_a = model::write_template(a.part, bytes_a);
  const auto size_b = model::write_template(b.part, bytes_b);
  ASSERT_TRUE(size_a);
  ASSERT_TRUE(size_b);
  EXPECT_EQ(bytes_a, bytes_b);
}

TEST(Teacher, NeverAllocates) {
  const MadeScan first = test::bin_scan({{test::pose_at(70, 60, 10, 0.5)}});
  const MadeScan second = test::bin_scan({{test::pose_at(60, 50, 10, 1.0)}});
  const locate::Limits limits = test::small_limits();
  std::vector<std::byte> memory(Teacher::required_bytes(limits));
  const TeachScan scans[] = {{first.view(), frames_of_scan(true)},
                             {second.view(), frames_of_scan(true)}};
  model::Template part;
  TeachReport report;
  Status s = Status::kNoPart;
  long count = -1;
  {
    const test::AllocationGuard guard;
    Teacher teacher;
    (void)teacher.init(limits, memory);
    s = teacher.teach(scans, {}, part, report);
    count = guard.count();
  }
  EXPECT_EQ(s, Status::kOk);
  EXPECT_EQ(report.scan_count_used, 2);
  EXPECT_EQ(count, 0);
}

}  // namespace
}  // namespace flatpose::teach
