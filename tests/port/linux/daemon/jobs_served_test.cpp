// What a job says of its poses, through the daemon: picks, frames, preferences.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "port/linux/files/work_file.hpp"
#include "port/linux/tool/work_plane.hpp"
#include "tests/port/linux/daemon/rows.hpp"
#include "tests/port/linux/daemon/served.hpp"

namespace flatpose::daemon {
namespace {

using job::Answer;

class JobsServed : public Served {
 protected:
  static void expect_at(const Plc::Block& block, const Rows& face_T_reported) {
    // The registers' numbers come from another order of sums: a unit in the last place.
    const Pose pose = face_T_reported.pose();
    EXPECT_NEAR(static_cast<double>(block[Field::kPositionX]), pose.position_mm.x * 1000, 1.01);
    EXPECT_NEAR(static_cast<double>(block[Field::kPositionY]), pose.position_mm.y * 1000, 1.01);
    EXPECT_NEAR(static_cast<double>(block[Field::kPositionZ]), pose.position_mm.z * 1000, 1.01);
    const std::array<double, 4> numbers{
        static_cast<double>(block[Field::kRotation1]) * 1e-3 * M_PI / 180,
        static_cast<double>(block[Field::kRotation2]) * 1e-3 * M_PI / 180,
        static_cast<double>(block[Field::kRotation3]) * 1e-3 * M_PI / 180, 0};
    const Rows told = Rows::about(2, numbers[0] * 180 / M_PI) *
                      Rows::about(1, numbers[1] * 180 / M_PI) *
                      Rows::about(0, numbers[2] * 180 / M_PI);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(told.m[i][j], face_T_reported.m[i][j], 4e-5);
  }
};

TEST_F(JobsServed, PickIsComposedWithTheObjectsPose) {
  // The first pick lies outside, by its x; the second is told, the third never.
  const std::string picks =
      "[[part]]\nname = \"gripped\"\nfile = \"" FLATPOSE_EXAMPLE
      "/pad.fpt\"\n"
      "[[part.pick]]\nposition_mm = [5000, 0, 0]\npriority = 9\n"
      "[[part.pick]]\nposition_mm = [1, 0, 0]\n"
      "[[part.pick]]\nposition_mm = [12, -7, 3]\nrotation = [30, 10, 170]\ntool = 4\n"
      "priority = 3\n"
      "[[job]]\nnumber = 2\nparts = [\"gripped\"]\nlimit_x_mm = [-1000, 1000]\n"
      "[[job]]\nnumber = 3\nparts = [\"gripped\"]\npose = \"object\"\n"
      "[[job]]\nnumber = 4\nparts = [\"pad\"]\npose = \"pick\"\n";
  const std::string config = dry_run({}, picks);
  const auto own = located(config, kScan);
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Rows scan_T_object = Rows::of(own->matches[0].face_T_object);

  const Plc::Block object = plc.trigger(1, 0, 1, 1);
  EXPECT_EQ(object[Field::kTool], 0);
  EXPECT_EQ(object[Field::kPick], 0);
  expect_at(object, scan_T_object);

  const Plc::Block pick = plc.trigger(2, 0, 1, 2);
  EXPECT_EQ(pick[Field::kTool], 4);
  EXPECT_EQ(pick[Field::kPick], 3);
  expect_at(pick, scan_T_object * Rows::at(12, -7, 3) * Rows::about(2, 30) * Rows::about(1, 10) *
                      Rows::about(0, 170));

  expect_at(plc.trigger(3, 0, 1, 3), scan_T_object);

  const Plc::Block usual = plc.trigger(4, 0, 1, 4);
  EXPECT_EQ(usual[Field::kTool], 1);
  EXPECT_EQ(usual[Field::kPick], 0);
  expect_at(usual, scan_T_object * Rows::about(0, 180));
}

TEST_F(JobsServed, ReferenceRotationChoosesTheBranch) {
  const std::string jobs =
      "pose = \"pick\"\n[[job]]\nnumber = 2\nparts = [\"pad\"]\npose = \"pick\"\n"
      "reference_rotation = [360, 0, 0]\n";
  RunningDaemon daemon({"--config", dry_run(jobs)});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block plain = plc.trigger(1, 0, 1, 1);
  const Plc::Block near = plc.trigger(2, 0, 1, 2);
  const auto turns = [](std::int64_t raw) { return static_cast<double>(raw) / 360'000.0; };
  const double apart = turns(near[Field::kRotation1]) - turns(plain[Field::kRotation1]);
  EXPECT_NEAR(apart, std::round(apart), 1e-5);
  EXPECT_NEAR(turns(near[Field::kRotation1]), 1.0, 0.5);
  EXPECT_LT(std::fabs(turns(plain[Field::kRotation1])), 0.5 + 1e-6);
}

TEST_F(JobsServed, RobotFrameIsTheAlignmentsTimesTheJsonsPose) {
  folder_.write("robot.json", robot_json(kRobotTScan));
  const std::string config = dry_run("frame = \"robot\"\nalignment = \"robot.json\"",
                                     "[[job]]\nnumber = 2\nparts = [\"pad\"]\nframe = "
                                     "\"robot\"\nalignment = \"robot.json\"\npose = "
                                     "\"object\"\n[[job]]\nnumber = 3\nparts = [\"pad\"]\n");
  const auto own =
      located(folder_.write("plain.toml",
                            "[search]\nscan_width_px = 400\n"
                            "scan_height_px = 333\ncell_count = "
                            "600_000\n[[part]]\nname = \"pad\"\nfile = "
                            "\"" FLATPOSE_EXAMPLE "/pad.fpt\"\n[[job]]\nparts = [\"pad\"]\n"),
              kScan);
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Rows robot_T_object = kRobotTScan * Rows::of(own->matches[0].face_T_object);
  // A robot is told where its tool goes: z into the surface.
  const Plc::Block pick = plc.trigger(1, 0, 1, 1);
  EXPECT_EQ(pick[Field::kFrame], static_cast<int>(job::FrameName::kRobot));
  EXPECT_EQ(pick[Field::kTool], 1);
  EXPECT_TRUE(pick.has(job::kValid));
  expect_at(pick, robot_T_object * Rows::about(0, 180));
  EXPECT_NE(pick[Field::kAlignmentHash], 0);
  expect_at(plc.trigger(2, 0, 1, 2), robot_T_object);
  const Plc::Block scan = plc.trigger(3, 0, 1, 3);
  EXPECT_EQ(scan[Field::kAlignmentHash], 0);
  expect_at(scan, Rows::of(own->matches[0].face_T_object));
}

TEST_F(JobsServed, RobotFrameWithoutAnAlignmentHasNoPose) {
  folder_.write("broken.json", "{");
  const auto job = [](int number, const char* more) {
    return "[[job]]\nnumber = " + std::to_string(number) +
           "\nparts = [\"pad\"]\nframe = \"robot\"\n" + more;
  };
  folder_.write("robot.json", robot_json(kRobotTScan));
  const std::string config =
      dry_run({}, job(2, "") + job(3, "alignment = \"none.json\"\n") +
                      job(4, "alignment = \"broken.json\"\n") +
                      job(5, "alignment = \"robot.json\"\nwork = \"none.json\"\n"));
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  for (std::uint16_t number = 2; number <= 5; ++number) {
    const Plc::Block block = plc.trigger(number, 0, 1, number);
    EXPECT_EQ(block[Field::kStatus], static_cast<int>(Answer::kNoAlignment));
    EXPECT_FALSE(block.has(job::kValid));
    EXPECT_EQ(block[Field::kPositionX], INT32_MIN);
  }
  EXPECT_EQ(plc.trigger(9)[Field::kStatus], 0);
  daemon.stop(SIGTERM);
  for (const char* part : {"job 2 has no alignment", "job 3 has no alignment", "none.json",
                           "job 4 has no alignment", "broken.json", "job 5 has no alignment"})
    EXPECT_NE(daemon.log().find(part), std::string::npos) << part << ":\n" << daemon.log();
}

/// The example's scan moved up by so much, or with every point missing (NaN).
std::string moved_scan(double up_mm) {
  const port::Scan scan = port::read_scan(kScan);
  const double z_up = scan.up == port::Up::kPlusZ ? 1.0 : -1.0;
  std::string text =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
      "COUNT 1 1 1\nWIDTH " +
      std::to_string(scan.width_px) + "\nHEIGHT " + std::to_string(scan.height_px) +
      "\nVIEWPOINT 0 0 " + (z_up > 0 ? "100000" : "-100000") + " 1 0 0 0\nPOINTS " +
      std::to_string(scan.xyz_mm.size() / 3) + "\nDATA binary\n";
  for (std::size_t i = 0; i < scan.xyz_mm.size(); ++i) {
    const bool is_z = i % 3 == 2;
    const auto value = std::isnan(up_mm)
                           ? std::nanf("")
                           : static_cast<float>(scan.xyz_mm[i] + (is_z ? z_up * up_mm : 0.0));
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return text;
}

/// The plane of the example's scan, as flatpose align finds it.
void write_plane(const std::string& path) {
  const port::Scan scan = port::read_scan(kScan);
  const auto plane =
      tool::find_work_plane(scan.view(), scan.up == port::Up::kPlusZ ? 1 : -1, 0.1, 1.5);
  ASSERT_TRUE(plane);
  port::write_work_file(path, {plane->work_T_scan, scan.up, {}});
}

constexpr auto kVerify = static_cast<std::uint16_t>(job::Command::kVerifyAlignment);

TEST_F(JobsServed, VerifyTellsWhetherThePlaneHoldsAndGuardsItsJobs) {
  write_plane(folder_.path("work.json"));
  folder_.write("robot.json", robot_json(kRobotTScan));
  const std::string scan = folder_.write("s.pcd", moved_scan(0.0));
  const std::string config = dry_run(
      "work = \"work.json\"\nframe = \"work\"",
      "[[job]]\nnumber = 2\nparts = [\"pad\"]\n"
      "[[job]]\nnumber = 3\nparts = [\"pad\"]\nframe = \"robot\"\nwork = \"work.json\"\n"
      "alignment = \"robot.json\"\n"
      "[[job]]\nnumber = 4\nparts = [\"pad\"]\nwork = \"work.json\"\nverify_shift_mm = 5\n");
  RunningDaemon daemon({"--config", config, "--scan", scan});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  std::uint16_t number = 0;
  const auto status = [&](std::uint16_t command, std::uint16_t job) {
    const Plc::Block block = plc.trigger(++number, 0, command, job);
    EXPECT_EQ(block.has(job::kValid), command == 1 && block[Field::kStatus] >= 0);
    return static_cast<Answer>(block[Field::kStatus]);
  };
  const auto shows = [&](double up_mm) {
    std::filesystem::rename(folder_.write("next.pcd", moved_scan(up_mm)), scan);
  };
  EXPECT_EQ(status(1, 1), Answer::kOk);
  EXPECT_EQ(status(kVerify, 1), Answer::kOk);
  EXPECT_EQ(plc.block()[Field::kScannedNumber], number);
  EXPECT_EQ(plc.block()[Field::kMatchCount], 0);
  EXPECT_NE(plc.block()[Field::kAlignmentHash], 0);
  EXPECT_EQ(status(kVerify, 2), Answer::kNoAlignment);  // there is no plane to verify
  EXPECT_EQ(status(1, 1), Answer::kOk);

  shows(2.0);
  EXPECT_EQ(status(1, 1), Answer::kOk);  // not yet verified
  EXPECT_EQ(status(kVerify, 1), Answer::kAlignmentMoved);
  EXPECT_TRUE(plc.block().has(job::kError));
  for (const std::uint16_t job : {std::uint16_t{1}, std::uint16_t{3}, std::uint16_t{4}})
    EXPECT_EQ(status(1, job), Answer::kAlignmentMoved) << job;
  EXPECT_EQ(status(1, 2), Answer::kOk);        // another frame is no matter of this plane
  EXPECT_EQ(status(kVerify, 4), Answer::kOk);  // that job allows more
  EXPECT_EQ(status(1, 1), Answer::kOk);
  EXPECT_EQ(status(kVerify, 3), Answer::kAlignmentMoved);

  shows(std::nan(""));
  EXPECT_EQ(status(kVerify, 1), Answer::kScanPoor);  // says nothing of the plane
  shows(0.0);
  EXPECT_EQ(status(1, 1), Answer::kAlignmentMoved);
  EXPECT_EQ(status(kVerify, 1), Answer::kOk);
  EXPECT_EQ(status(1, 1), Answer::kOk);
  EXPECT_EQ(status(1, 3), Answer::kOk);
  daemon.stop(SIGTERM);
  EXPECT_NE(daemon.log().find("the work plane of job 1 does not hold: moved +2.0"),
            std::string::npos)
      << daemon.log();
}

TEST_F(JobsServed, ExclusionsAndHeightsBoundTheSearch) {
  const std::string plain = dry_run();
  const Vec3 p = located(plain, kScan)->matches[0].face_T_object.position_mm;
  const auto number = [](double value) { return std::to_string(value); };
  const std::string there = "circle:" + number(p.x) + "," + number(p.y) + ",15";
  const std::string time = "answer_by_ms = 120000\n";  // on a machine with much else to do
  const std::string config =
      dry_run(time + "exclusions = [\"circle:5000,0,1\"]\nheight_mm = [" + number(p.z - 1) + ", " +
                  number(p.z + 1) + "]",
              "[[job]]\nnumber = 2\nparts = [\"pad\"]\n" + time +
                  "exclusions = [\"circle:5000,0,1\", \"" + there +
                  "\"]\n[[job]]\nnumber = 3\nparts = [\"pad\"]\n" + time + "height_mm = [" +
                  number(p.z + 40) + ", " + number(p.z + 90) + "]\n");
  RunningDaemon daemon({"--config", config});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Plc::Block inside = plc.trigger(1, 0, 1, 1);
  EXPECT_EQ(inside[Field::kStatus], 0);
  EXPECT_NEAR(static_cast<double>(inside[Field::kPositionX]), p.x * 1000, 1.01);
  for (const std::uint16_t job : {std::uint16_t{2}, std::uint16_t{3}}) {
    const Plc::Block block = plc.trigger(job, 0, 1, job);
    EXPECT_EQ(block[Field::kStatus], static_cast<int>(Answer::kNoMatch)) << job;
    EXPECT_FALSE(block.has(job::kValid));
  }
}

}  // namespace
}  // namespace flatpose::daemon
