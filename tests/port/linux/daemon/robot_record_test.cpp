// Records of a job in the robot's frame: record, picture and registers tell of the same pose.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/png_image.hpp"
#include "tests/port/linux/daemon/rows.hpp"
#include "tests/port/linux/daemon/served.hpp"

namespace flatpose::daemon {
namespace {

using nlohmann::json;

constexpr auto kCapture = static_cast<std::uint16_t>(job::Command::kCapture);

class RobotRecord : public Served {
 protected:
  /// What a trigger leaves behind.
  struct Left {
    Plc::Block block;
    json record;
    port::PngImage picture;
  };
  /// Jobs: 1 a pick in the robot's frame, 2 the object in it, 3 the object in the scan's.
  [[nodiscard]] std::string config() const {
    folder_.write("robot.json", robot_json(kRobotTScan));
    const std::string robot = "frame = \"robot\"\nalignment = \"robot.json\"\n";
    return dry_run(robot, "[[job]]\nnumber = 2\nparts = [\"pad\"]\npose = \"object\"\n" + robot +
                              "[[job]]\nnumber = 3\nparts = [\"pad\"]\n"
                              "[records]\nfolder = \"records\"\n");
  }
  Left trigger(Plc& plc, std::uint16_t number, std::uint16_t job, std::uint16_t command = 1) const {
    const std::string json_path = folder_.path("records/last.json");
    const std::string png_path = folder_.path("records/last.png");
    std::filesystem::remove(png_path);
    Left left{plc.trigger(number, 0, command, job), {}, {}};
    EXPECT_TRUE(comes_true([&] { return std::filesystem::exists(png_path); }));
    std::ifstream file(json_path);
    left.record = json::parse(file, nullptr, false);
    EXPECT_EQ(left.record["number"], number);
    const auto png = port::read_file(png_path, 64 << 20);
    left.picture = port::read_png(png_path, png, port::PngKind::kColour8, {});
    return left;
  }
};

Rows rows_of(const json& pose) {
  Rows rows;
  for (std::size_t i = 0; i < 3; ++i) {
    rows.m[i][3] = pose["position_mm"][i];
    for (std::size_t j = 0; j < 3; ++j) rows.m[i][j] = pose["rotation"][3 * i + j];
  }
  return rows;
}

void expect_same(const Rows& a, const Rows& b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(a.m[i][j], b.m[i][j], j == 3 ? 1e-6 : 1e-9);
}

/// What lies above the legend.
std::vector<std::uint8_t> map_of(const port::PngImage& picture) {
  constexpr int kLegend_px = 54;
  const auto rows = static_cast<std::size_t>(picture.height_px - kLegend_px);
  const auto end = static_cast<std::ptrdiff_t>(4 * rows * picture.width_px);
  return {picture.rgba.begin(), picture.rgba.begin() + end};
}

TEST_F(RobotRecord, TellsWhatTheRegistersShowedInTheirFrame) {
  RunningDaemon daemon({"--config", config()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const Left pick = trigger(plc, 1, 1);
  const Left object = trigger(plc, 2, 2);
  const Left scan = trigger(plc, 3, 3);

  for (const Left* left : {&pick, &object}) {
    EXPECT_EQ(left->record["frame"], "robot");
    EXPECT_EQ(left->record["told"]["frame"], "robot");
    EXPECT_EQ(left->block[Field::kFrame], static_cast<int>(job::FrameName::kRobot));
  }
  EXPECT_EQ(scan.record["frame"], "scan");
  for (const Left* left : {&pick, &object, &scan}) {
    const json& told = left->record["told"];
    ASSERT_EQ(told["matches"].size(), 1U);
    expect_pose(left->block, rows_of(told["matches"][0]).pose(), Convention::kKukaAbc);
    EXPECT_EQ(told["alignment_hash"], left->block[Field::kAlignmentHash]);
  }
  const Rows robot_T_object = kRobotTScan * rows_of(scan.record["matches"][0]);
  expect_same(rows_of(pick.record["matches"][0]), robot_T_object);
  expect_same(rows_of(object.record["matches"][0]), robot_T_object);
  expect_same(rows_of(object.record["told"]["matches"][0]), robot_T_object);
  expect_same(rows_of(pick.record["told"]["matches"][0]), robot_T_object * Rows::about(0, 180));
}

// The same part in the same scan: the drawing is the same, and only the legend tells the frame.
TEST_F(RobotRecord, PictureHasThePartWhereItLies) {
  RunningDaemon daemon({"--config", config()});
  Plc plc(daemon.port());
  ASSERT_TRUE(plc.waits_until_ready());
  const port::PngImage robot = trigger(plc, 1, 2).picture;
  const port::PngImage scan = trigger(plc, 2, 3).picture;
  const port::PngImage robots_again = trigger(plc, 3, 1).picture;
  const port::PngImage captured = trigger(plc, 4, 1, kCapture).picture;
  ASSERT_EQ(map_of(robot).size(), map_of(scan).size());
  const auto differing = [](const port::PngImage& a, const port::PngImage& b) {
    const auto one = map_of(a), other = map_of(b);
    std::size_t count = 0;
    for (std::size_t i = 0; i < one.size(); ++i) count += one[i] != other[i] ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(one.size());
  };
  // The last bits of a pose may move an anti-aliased border.
  EXPECT_LT(differing(robot, scan), 1e-3);
  EXPECT_LT(differing(robot, robots_again), 1e-3);
  EXPECT_GT(differing(captured, scan), 3e-3);  // there is no contour in it
}

}  // namespace
}  // namespace flatpose::daemon
