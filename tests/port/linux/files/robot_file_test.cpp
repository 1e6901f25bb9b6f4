#include "port/linux/files/robot_file.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/touch_file.hpp"
#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

RobotFile some_robot() {
  return {{rotation_from_vector({3.0, 0.1, -0.2}), {1.0 / 3.0, -1e-7, 299.25}},
          RobotQuality{0.25, 0.5, 0.75},
          {{3, {1, 2, 3}, {4, 5, 6}, 0.5}}};
}

TEST(RobotFile, ReadsBackWhatIsWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.path("robot.json");
  write_robot_file(path, some_robot());
  const RobotFile back = read_robot_file(path);
  EXPECT_EQ(back.robot_T_scan.rotation.m, some_robot().robot_T_scan.rotation.m);
  EXPECT_EQ(back.robot_T_scan.position_mm, some_robot().robot_T_scan.position_mm);
  ASSERT_TRUE(back.quality);
  EXPECT_EQ(back.quality->rms_mm, 0.25);
  EXPECT_EQ(back.quality->worst_mm, 0.5);
  EXPECT_EQ(back.quality->leave_one_out_mm, 0.75);
}

constexpr const char* kByHand = R"({"format": "flatpose-robot", "version": 1, "robot_T_scan":
      {"position_mm": [0, 0, -5], "rotation": [1,0,0, 0,1,0, 0,0,1]},
      "quality": {"rms_mm": 0.1, "worst_mm": 0.5, "leave_one_out_mm": 9}})";

TEST(RobotFile, ReadsAnotherCalibrationsWithoutAHash) {
  const TemporaryFolder folder;
  const RobotFile robot = read_robot_file(folder.write("r.json", kByHand));
  EXPECT_EQ(robot.robot_T_scan.position_mm, (Vec3{0, 0, -5}));
}

TEST(RobotFile, RefusesAPoseThatWasChangedByHand) {
  const TemporaryFolder folder;
  const std::string path = folder.path("robot.json");
  RobotFile robot = some_robot();
  robot.robot_T_scan.position_mm = {125.5, 0, 0};
  write_robot_file(path, robot);
  const std::string text(as_text(read_file(path, 10'000)));
  const std::string changed = folder.write("c.json", replaced(text, "125.5", "126.5"));
  expect_input_error([&] { (void)read_robot_file(changed); }, {"changed by hand"});
}

TEST(RobotFile, NamesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto refused = [&](std::string_view from, std::string_view to,
                           std::initializer_list<std::string_view> parts) {
    const std::string path = folder.write("r.json", replaced(kByHand, from, to));
    expect_input_error([&] { (void)read_robot_file(path); }, parts);
  };
  refused("flatpose-robot", "flatpose-work", {"is no robot file", "--touch"});
  refused("1, \"robot", "2, \"robot", {"version 2 is not the known 1", "newer flatpose"});
  refused("robot_T_scan", "work_T_scan", {"has no \"robot_T_scan\""});
  refused("-5]", "2e6]", {"position_mm[2] lies beyond"});
  refused("[1,0,0,", "[-1,0,0,", {"rotation is no rotation", "determinant"});
  refused("0.1", "-0.1", {"rms_mm is below 0"});
  refused("0.5", "\"x\"", {"worst_mm is not a number"});
  const std::string good = kByHand;
  for (std::size_t size = 0; size < good.size(); ++size) {
    const std::string path = folder.write("r.json", good.substr(0, size));
    expect_input_error([&] { (void)read_robot_file(path); }, {"r.json"});
  }
}

TEST(RobotFile, RefusesToWriteWhatCannotBeRead) {
  const TemporaryFolder folder;
  RobotFile robot = some_robot();
  robot.robot_T_scan.position_mm.x = std::numeric_limits<double>::quiet_NaN();
  expect_input_error([&] { write_robot_file(folder.path("r"), robot); }, {"finite rigid pose"});
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(TouchFile, IsReadWithAndWithoutNamesCommentsAndInAnyOrder) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return read_touch_file(folder.write("p.csv", text));
  };
  for (const char* text :
       {"1,2,3,4,5,6\n", "1;2;3;4;5;6", "# touched\n\n 1 , 2 ,3,\t4,5,6 # first\r\n",
        "scan_x,scan_y,scan_z,robot_x,robot_y,robot_z\n1,2,3,4,5,6\n",
        "robot_x;robot_y;robot_z;scan_z;scan_y;scan_x\n4;5;6;3;2;1\n",
        "\xEF\xBB\xBF\"scan_x\",\"scan_y\",\"scan_z\",\"robot_x\",\"robot_y\",\"robot_z\"\n"
        "1,+2,3.0,4e0,5,6\n"}) {
    const auto pairs = read(text);
    ASSERT_EQ(pairs.size(), 1U) << text;
    EXPECT_EQ(pairs[0].scan_mm, (Vec3{1, 2, 3})) << text;
    EXPECT_EQ(pairs[0].robot_mm, (Vec3{4, 5, 6})) << text;
  }
  EXPECT_EQ(read("# one\n1,2,3,4,5,6\n\n7,8,9,10,11,12\n").at(1).line, 4);
  EXPECT_TRUE(read("").empty());
}

TEST(TouchFile, NamesLineAndRemedy) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string_view> parts) {
    const std::string path = folder.write("p.csv", text);
    expect_input_error([&] { (void)read_touch_file(path); }, parts);
  };
  refused("1,2,3,4,5\n", {"p.csv:1: there are 5 numbers, not 6", "scan_x,scan_y"});
  refused("1,2,3,4,5,6\n#\n1,2,3,4,5,6,7\n", {"p.csv:3: there are 7"});
  refused("1,2,3,4,5,6\n1,2,3,4,5,six\n", {"p.csv:2: 'six' is no number"});
  refused("1,2,3,4,5,\n", {"p.csv:1: '' is no number"});
  refused("1,2,3,4,5,nan\n", {"is no number"});
  refused("1,2,3,4,5,1e7\n", {"lies beyond"});
  refused("1,2,3,4,5,1e999\n", {"is no number"});
  refused("1,2,3,4,5,6 7\n", {"'6 7' is no number"});
  refused("scan_x,scan_y,scan_z,robot_x,robot_y\n", {"p.csv:1: ", "six columns"});
  refused("scan_x,scan_y,scan_z,robot_x,robot_y,robot_y\n", {"six columns"});
  refused("x,y,z,a,b,c\n", {"six columns"});
  refused("1,2,3,4,5,6\nscan_x,scan_y,scan_z,robot_x,robot_y,robot_z\n", {"p.csv:2: "});
  refused("1,2,3,4,5,\x1b[31m\n", {"\\x1b"});
  std::string many;
  for (std::size_t i = 0; i <= kTouchedPairsMax; ++i) many += "1,2,3,4,5,6\n";
  refused(many, {"more than 10000 pairs"});
}

}  // namespace
}  // namespace flatpose::port
