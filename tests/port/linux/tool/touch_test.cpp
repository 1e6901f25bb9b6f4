// flatpose align --touch: the robot's frame from touched points.

#include <cmath>
#include <random>

#include "port/linux/files/robot_file.hpp"
#include "port/linux/files/work_file.hpp"
#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

const Pose kRobotTScan{rotation_from_vector({3.0, 0.2, -0.4}), {850, -200, 1200}};

class Touch : public Workbench {
 protected:
  using Points = std::vector<Vec3>;

  static Points table(int count, double depth_mm = 0.0) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> within(-1, 1);
    Points points;
    for (int i = 0; i < count; ++i)
      points.push_back(
          {200 * within(random), 150 * within(random), 600 + depth_mm * within(random)});
    return points;
  }
  static std::string line(const Vec3& scan, const Vec3& robot) {
    char text[200];
    std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", scan.x, scan.y, scan.z,
                  robot.x, robot.y, robot.z);
    return text;
  }
  static std::string pairs(const Points& points, const Pose& robot_T_scan = kRobotTScan,
                           double noise_mm = 0.0) {
    std::mt19937 random(7);
    std::normal_distribution<double> noise;
    std::string text = "# touched\n";
    for (const Vec3& p : points) {
      const Vec3 off{noise(random), noise(random), noise(random)};
      text += line(p, robot_T_scan * p + noise_mm * off);
    }
    return text;
  }
  [[nodiscard]] Ran align(const std::string& text, const Words& more = {}) const {
    folder_.write("p.csv", text);
    Words words{"align", "--touch", path("p.csv"), "-o", path("robot.json")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  void expect_nothing_written() const { EXPECT_EQ(read("robot.json"), ""); }
};

TEST_F(Touch, FindsTheFrameAlsoFromPointsOfTheTableAlone) {
  for (const double depth_mm : {0.0, 80.0}) {
    const Ran ran = align(pairs(table(6, depth_mm)));
    ASSERT_EQ(ran.code, 0) << ran.err;
    const Pose found = port::read_robot_file(path("robot.json")).robot_T_scan;
    const Vec3 far{100, 100, 500};
    EXPECT_NEAR(norm(found * far - kRobotTScan * far), 0.0, 1e-4);
    EXPECT_EQ(ran.out.find("one plane") != std::string::npos, depth_mm == 0.0) << ran.out;
  }
}

TEST_F(Touch, ToldResidualsAreThoseOfTheFit) {
  const Points points = table(8, 60.0);
  const Ran ran = align(pairs(points, kRobotTScan, 0.4));
  ASSERT_EQ(ran.code, 0) << ran.err;
  const json file = read_json("robot.json");
  const Pose found = pose_of(file.at("robot_T_scan"));
  double squares = 0.0, worst = 0.0;
  for (const json& pair : file.at("pairs")) {
    const auto s = pair.at("scan_mm").get<std::vector<double>>();
    const auto r = pair.at("robot_mm").get<std::vector<double>>();
    const double off = norm(found * Vec3{s[0], s[1], s[2]} - Vec3{r[0], r[1], r[2]});
    EXPECT_NEAR(pair.at("residual_mm").get<double>(), off, 1e-9);
    squares += off * off;
    worst = std::max(worst, off);
  }
  const json& quality = file.at("quality");
  EXPECT_NEAR(quality.at("rms_mm").get<double>(), std::sqrt(squares / 8), 1e-9);
  EXPECT_NEAR(quality.at("worst_mm").get<double>(), worst, 1e-9);
  // What is left out is off by more than what was fitted.
  EXPECT_GT(quality.at("leave_one_out_mm").get<double>(), std::sqrt(squares / 8));
  EXPECT_LT(quality.at("leave_one_out_mm").get<double>(), 5.0);
  EXPECT_NE(ran.out.find("line 9: off by "), std::string::npos) << ran.out;
}

TEST_F(Touch, PointsOfTheWorkFrameCountFromIt) {
  const Pose work_T_scan{rotation_from_vector({3.0, 0, 0}), {10, 20, 600}};
  port::write_work_file(path("work.json"), {work_T_scan, port::Up::kMinusZ, {}});
  const Ran ran = align(pairs(table(5, 50), kRobotTScan * work_T_scan.inverse()),
                        {"--work", path("work.json")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Pose found = port::read_robot_file(path("robot.json")).robot_T_scan;
  EXPECT_NEAR(norm(found * Vec3{1, 2, 500} - kRobotTScan * Vec3{1, 2, 500}), 0.0, 1e-4);
}

TEST_F(Touch, TooFewAndThoseOnALineAreRefused) {
  expect_refused(align(pairs(table(3, 50))), 2, "at least four");
  expect_refused(align("# none\n"), 2, "at least four");
  Points on_a_line;
  for (int i = 0; i < 8; ++i) on_a_line.push_back({50.0 * i, 20.0 * i + i % 2, 600});
  expect_refused(align(pairs(on_a_line)), 2, "nearly on one line");
  Points same(6, Vec3{1, 2, 3});
  expect_refused(align(pairs(same)), 2, "nearly on one line");
  // Touched at one place again and again, whatever the scan says.
  std::string text;
  for (const Vec3& p : table(6, 50)) text += line(p, {1, 2, 3});
  expect_refused(align(text), 2, "on the robot's side");
  expect_nothing_written();
}

TEST_F(Touch, WrongUnitsAreNamed) {
  struct Case {
    double factor;
    const char* part;
  };
  for (const Case& unit :
       {Case{0.001, "robot's columns look like metres"},
        Case{1000.0, "scan's columns look like metres"},
        Case{0.1, "robot's columns look like centimetres"},
        Case{1 / 25.4, "robot's columns look like inches"}, Case{2.0, "no unit is so"}}) {
    std::string text;
    for (const Vec3& p : table(6, 50)) text += line(p, unit.factor * (kRobotTScan * p));
    expect_refused(align(text), 2, unit.part);
  }
  expect_nothing_written();
}

TEST_F(Touch, MirroredAndExchangedColumnsAreNamed) {
  std::string mirrored, exchanged;
  for (const Vec3& p : table(6, 80)) {
    const Vec3 r = kRobotTScan * p;
    mirrored += line(p, {r.x, -r.y, r.z});
    exchanged += line(p, {r.y, r.x, r.z});
  }
  expect_refused(align(mirrored), 2, "mirrored");
  expect_refused(align(exchanged), 2, "check the columns' order");
}

TEST_F(Touch, OneBadPairIsNamedByItsLine) {
  std::string text;
  int number = 0;
  for (const Vec3& p : table(7, 80)) {
    const Vec3 r = kRobotTScan * p;
    text += line(p, ++number == 4 ? r + Vec3{0, 25, 0} : r);
  }
  expect_refused(align(text), 2, "p.csv:4: this pair does not fit");
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 20.0);
  text.clear();
  for (const Vec3& p : table(7, 80))
    text += line(p, kRobotTScan * p + Vec3{noise(random), noise(random), noise(random)});
  expect_refused(align(text), 2, "do not fit");
  EXPECT_EQ(align(text, {"--max-rms", "100"}).code, 0);
}

TEST_F(Touch, CommandLinesThatMakeNoSenseAreRefused) {
  folder_.write("p.csv", pairs(table(5, 50)));
  expect_refused(run({"align", "--touch", path("p.csv")}), 2, "-o FILE.json");
  expect_refused(run({"align", "a.pcd", "--touch", path("p.csv"), "-o", path("r")}), 2, "no SCAN");
  expect_refused(run({"align", "-o", path("r")}), 2, "neither SCAN nor --touch");
  expect_refused(run({"align", "a.pcd", "-o", path("r"), "--work", "w"}), 2, "--touch alone");
  expect_refused(run({"align", "--touch", path("none.csv"), "-o", path("r")}), 2, "none.csv");
  expect_refused(run({"align", "--touch", path("p.csv"), "-o", path("p.csv")}), 2, "is read");
}

TEST_F(Touch, InfoTellsTheRobotFile) {
  ASSERT_EQ(align(pairs(table(5, 50))).code, 0);
  const json told = json::parse(run({"info", path("robot.json"), "--json"}).out);
  EXPECT_EQ(told.at("kind"), "robot");
  EXPECT_NEAR(pose_of(told.at("robot_T_scan")).position_mm.x, 850, 1e-3);
  EXPECT_NE(run({"info", path("robot.json")}).out.find("robot frame"), std::string::npos);
}

}  // namespace
}  // namespace flatpose::tool
