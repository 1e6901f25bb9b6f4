#include "port/linux/daemon/alignment.hpp"

#include <gtest/gtest.h>

#include "port/linux/files/robot_file.hpp"
#include "port/linux/files/work_file.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

using job::FrameName;

const Pose kWorkTScan{rotation_from_vector({3.0, 0.1, 0.0}), {5, 6, 600}};
const Pose kRobotTScanPose{rotation_from_vector({0.2, 3.0, 0.0}), {900, 0, 700}};
const Vec3 kPoint{10, 20, 590};

class AlignmentTest : public testing::Test {
 protected:
  AlignmentTest() {
    port::write_work_file(work_, {kWorkTScan, port::Up::kMinusZ, {}});
    port::write_robot_file(robot_, {kRobotTScanPose, {}, {}});
  }
  static void expect_same(const Vec3& a, const Vec3& b) { EXPECT_NEAR(norm(a - b), 0.0, 1e-9); }
  /// A point of the scan as the frame at the face has it.
  static Vec3 told(const Frames& frames) {
    return frames.face_T_work * (frames.work_T_scan * kPoint);
  }

  port::TemporaryFolder folder_;
  std::string work_ = folder_.path("work.json");
  std::string robot_ = folder_.path("robot.json");
};

TEST_F(AlignmentTest, PointsOfTheScanComeOutInTheFrameAsked) {
  const auto scan = load_alignment("", "", FrameName::kScan, {});
  ASSERT_TRUE(scan.serves(FrameName::kScan));
  expect_same(told(scan.frames(FrameName::kScan, port::Up::kMinusZ)), kPoint);
  EXPECT_EQ(scan.hash, 0U);
  const auto work = load_alignment(work_, "", FrameName::kWork, {});
  ASSERT_TRUE(work.serves(FrameName::kWork));
  expect_same(told(work.frames(FrameName::kWork, port::Up::kMinusZ)), kWorkTScan * kPoint);
  for (const std::string& named : {std::string(), work_}) {
    const auto robot = load_alignment(named, robot_, FrameName::kRobot, {});
    ASSERT_TRUE(robot.serves(FrameName::kRobot));
    expect_same(told(robot.frames(FrameName::kRobot, port::Up::kMinusZ)), kRobotTScanPose * kPoint);
  }
}

TEST_F(AlignmentTest, WorkSaysWhereUpIsInEveryFrame) {
  for (const FrameName frame : {FrameName::kScan, FrameName::kWork, FrameName::kRobot}) {
    const auto alignment = load_alignment(work_, robot_, frame, {});
    const Frames frames = alignment.frames(frame, port::Up::kMinusZ);
    expect_same(frames.work_T_scan * kPoint, kWorkTScan * kPoint);
  }
  const auto scan = load_alignment(work_, "", FrameName::kScan, {});
  expect_same(told(scan.frames(FrameName::kScan, port::Up::kMinusZ)), kPoint);
}

TEST_F(AlignmentTest, WithoutWhatWasNamedThereIsNone) {
  const std::string none = folder_.path("none.json");
  const auto no_work = load_alignment(none, robot_, FrameName::kRobot, {});
  EXPECT_FALSE(no_work.serves(FrameName::kRobot));
  EXPECT_NE(no_work.problem.find("none.json"), std::string::npos);
  const auto no_robot = load_alignment(work_, none, FrameName::kRobot, {});
  EXPECT_FALSE(no_robot.serves(FrameName::kRobot));
  EXPECT_FALSE(load_alignment("", "", FrameName::kRobot, {}).serves(FrameName::kRobot));
  EXPECT_FALSE(load_alignment(none, "", FrameName::kScan, {}).serves(FrameName::kScan));
  EXPECT_FALSE(load_alignment(none, "", FrameName::kWork, {}).serves(FrameName::kWork));
  // The other file of its kind is none either.
  EXPECT_FALSE(load_alignment(robot_, "", FrameName::kWork, {}).serves(FrameName::kWork));
  EXPECT_FALSE(load_alignment("", work_, FrameName::kRobot, {}).serves(FrameName::kRobot));
  const auto other_up = load_alignment(work_, "", FrameName::kWork, port::Up::kPlusZ);
  EXPECT_FALSE(other_up.serves(FrameName::kWork));
  EXPECT_NE(other_up.problem.find("up"), std::string::npos);
}

TEST_F(AlignmentTest, HashCoversBothFiles) {
  const auto first = load_alignment(work_, robot_, FrameName::kRobot, {}).hash;
  EXPECT_NE(first, 0U);
  EXPECT_EQ(load_alignment(work_, robot_, FrameName::kRobot, {}).hash, first);
  Pose moved = kWorkTScan;
  moved.position_mm.z += 1.0;
  port::write_work_file(work_, {moved, port::Up::kMinusZ, {}});
  const auto second = load_alignment(work_, robot_, FrameName::kRobot, {}).hash;
  EXPECT_NE(second, first);
  moved = kRobotTScanPose;
  moved.position_mm.x += 1.0;
  port::write_robot_file(robot_, {moved, {}, {}});
  EXPECT_NE(load_alignment(work_, robot_, FrameName::kRobot, {}).hash, second);
}

}  // namespace
}  // namespace flatpose::daemon
