// Simulate, teach, locate, and hold the pose against the truth. The taught frame is not the
// simulator's: what both agree on is how the part moved between two scans.

#include <functional>
#include <map>

#include "flatpose/core/maths.hpp"
#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

double tilt_between_deg(const Pose& a, const Pose& b) {
  return arc_cosine(dot(a.rotation.column(2), b.rotation.column(2))) * kDegPerRad;
}

double turn_between_deg(const Pose& a, const Pose& b) {
  return angle_between_rad(a.rotation, b.rotation) * kDegPerRad;
}

const Words kWide{"--cols", "300", "--rows", "250"};  // more parts need more room

class RoundTrip : public Workbench {
 protected:
  /// Teaches part A of scan `a` and returns simulator-object_T_taught-object.
  Pose learn(const json& truth, const Words& more = {}) {
    taught_ = teach("a.pcd", "pad.fpt", more);
    return pose_of(truth.at("instances")[0]).inverse() * pose_of(taught_.at("taught_pose"));
  }
  void expect_near(const Pose& found, const Pose& expected) {
    EXPECT_LT(norm(found.position_mm - expected.position_mm), 1.0);
    EXPECT_LT(tilt_between_deg(found, expected), 1.0);
    EXPECT_LT(turn_between_deg(found, expected), 1.0);
  }
  json taught_;
};

TEST_F(RoundTrip, PoseIsWithinAMillimetreAndADegreeOfTheTruth) {
  const Pose sim_T_taught = learn(simulate("single", 3, "a.pcd"));
  for (const int seed : {4, 5}) {
    const json truth = simulate_as("low", seed, "b.pcd", kWide);
    const json found = locate("pad.fpt", "b.pcd");
    ASSERT_EQ(found.at("matches").size(), 1U);
    expect_near(pose_of(found.at("matches")[0]), pose_of(truth.at("instances")[0]) * sim_T_taught);
  }
}

TEST_F(RoundTrip, TaughtPoseIsFoundAgainInItsOwnScan) {
  learn(simulate("single", 3, "a.pcd"));
  const json found = locate("pad.fpt", "a.pcd");
  const Pose again = pose_of(found.at("matches")[0]);
  const Pose taught = pose_of(taught_.at("taught_pose"));
  EXPECT_LT(norm(again.position_mm - taught.position_mm), 0.3);
  EXPECT_LT(turn_between_deg(again, taught), 0.3);
}

TEST_F(RoundTrip, OriginAndAxisAreAsGiven) {
  const json truth = simulate("single", 3, "a.pcd");
  const Pose sim_T_taught = learn(truth, {"--origin", "-4,10.5", "--x-axis", "0,-1"});
  const Pose taught = pose_of(taught_.at("taught_pose"));
  EXPECT_NEAR(taught.position_mm.x, -4.0, 1e-9);
  EXPECT_NEAR(taught.position_mm.y, 10.5, 1e-9);
  EXPECT_LT(taught.rotation.m[3], -0.99);
  const json moved = simulate_as("low", 4, "b.pcd", kWide);
  const json found = locate("pad.fpt", "b.pcd");
  expect_near(pose_of(found.at("matches")[0]), pose_of(moved.at("instances")[0]) * sim_T_taught);
}

TEST_F(RoundTrip, TiltedPartIsFound) {
  const Pose sim_T_taught = learn(simulate("single", 3, "a.pcd"));
  const json truth = simulate("tilt", 2, "b.pcd", {"--tilt-x", "12", "--tilt-y", "-8"});
  const json found = locate("pad.fpt", "b.pcd");
  ASSERT_EQ(found.at("matches").size(), 1U);
  expect_near(pose_of(found.at("matches")[0]), pose_of(truth.at("instances")[0]) * sim_T_taught);
  locate("pad.fpt", "b.pcd", {"--max-tilt", "5"}, 1);
}

TEST_F(RoundTrip, TwoPartsComeInOrderAndWithinTheLimit) {
  learn(simulate("single", 3, "a.pcd"));
  simulate("lone", 6, "b.pcd");
  EXPECT_EQ(locate("pad.fpt", "b.pcd").at("matches").size(), 1U);
  const std::map<std::string, std::function<double(const json&)>> keys{
      {"score",
       [](const json& m) { return m.at("score").get<double>() * m.at("visible").get<double>(); }},
      {"height", [](const json& m) { return m.at("position_mm")[2].get<double>(); }},
      {"visible", [](const json& m) { return m.at("visible").get<double>(); }}};
  for (const auto& [order, key] : keys) {
    const json matches =
        locate("pad.fpt", "b.pcd", {"--max-matches", "5", "--order", order}).at("matches");
    ASSERT_EQ(matches.size(), 2U) << order;
    EXPECT_GE(key(matches[0]), key(matches[1])) << order;
  }
}

TEST_F(RoundTrip, RegionKeepsMatchesIn) {
  learn(simulate("single", 3, "a.pcd"));
  simulate("lone", 6, "b.pcd");
  const json both = locate("pad.fpt", "b.pcd", {"--max-matches", "5"}).at("matches");
  ASSERT_EQ(both.size(), 2U);
  for (const json& one : both) {
    const Vec3 p = pose_of(one).position_mm;
    const std::string region = "circle:" + std::to_string(p.x) + "," + std::to_string(p.y) + ",15";
    const json kept =
        locate("pad.fpt", "b.pcd", {"--max-matches", "5", "--region", region}).at("matches");
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_LT(norm(pose_of(kept[0]).position_mm - p), 1.0);
  }
  EXPECT_EQ(locate("pad.fpt", "b.pcd", {"--region", "circle:9000,0,15"}, 1).at("matches").size(),
            0U);
}

TEST_F(RoundTrip, SameScanGivesTheSameDigest) {
  learn(simulate("single", 3, "a.pcd"));
  simulate("lone", 6, "b.pcd");
  const json a = locate("pad.fpt", "b.pcd", {"--max-matches", "5"});
  const json b = locate("pad.fpt", "b.pcd", {"--max-matches", "5", "--threads", "3"});
  EXPECT_EQ(a.at("digest"), b.at("digest"));
  EXPECT_EQ(a.at("matches"), b.at("matches"));
  EXPECT_NE(a.at("digest"), locate("pad.fpt", "a.pcd").at("digest"));
}

TEST_F(RoundTrip, SameLessonGivesTheSameBytes) {
  learn(simulate("single", 3, "a.pcd"));
  const std::string bytes = read("pad.fpt");
  teach("a.pcd", "pad.fpt");
  EXPECT_EQ(read("pad.fpt"), bytes);
}

TEST_F(RoundTrip, AbsentPartIsNoMatch) {
  learn(simulate("single", 3, "a.pcd"));
  simulate("single", 4, "b.pcd", {"--part", "bracket"});
  const json found = locate("pad.fpt", "b.pcd", {}, 1);
  EXPECT_EQ(found.at("status"), "no_match");
  simulate("empty", 4, "c.pcd");
  EXPECT_TRUE(locate("pad.fpt", "c.pcd", {}, 1).at("matches").empty());
}

TEST_F(RoundTrip, WorkFramePutsAllOnThePlane) {
  const json truth = simulate("single", 3, "a.pcd");
  ASSERT_EQ(run({"align", path("a.pcd"), "-o", path("work.json")}).code, 0);
  const Words work{"--work", path("work.json")};
  learn(truth, work);
  EXPECT_EQ(taught_.at("frame"), "work");
  EXPECT_EQ(taught_.at("taught_pose").at("frame"), "work");
  const json found = locate("pad.fpt", "a.pcd", work);
  EXPECT_EQ(found.at("frame"), "work");
  EXPECT_EQ(found.at("up_reason"), "work");
  const Pose pose = pose_of(found.at("matches")[0]);
  EXPECT_NEAR(pose.position_mm.z, 8.0, 0.2);  // the pad's thickness
  EXPECT_GT(pose.rotation.m[8], 0.999);
}

TEST_F(RoundTrip, FreeTurnHasNoSigma) {
  simulate_as("single", 3, "a.pcd",
              {"--part", "washer", "--cols", "250", "--rows", "200", "--field-x-mm", "250",
               "--field-y-mm", "200"});
  const json taught = teach("a.pcd", "washer.fpt", {"--symmetry", "full"});
  EXPECT_EQ(taught.at("symmetry").at("order"), "full");
  const json found = locate("washer.fpt", "a.pcd");
  ASSERT_EQ(found.at("matches").size(), 1U);
  const json& sigma = found.at("matches")[0].at("sigma_deg");
  EXPECT_TRUE(sigma[0].is_number());
  EXPECT_TRUE(sigma[2].is_null());
}

TEST_F(RoundTrip, MoreScansAreUsed) {
  simulate("single", 3, "a.pcd");
  simulate("single", 8, "b.pcd");
  const Ran ran = run({"teach", path("a.pcd"), path("b.pcd"), "-o", path("pad.fpt"), "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(json::parse(ran.out).at("scans_used"), 2);
}

TEST_F(RoundTrip, DeadlineIsAnOutcome) {
  learn(simulate("single", 3, "a.pcd"));
  const json found = locate("pad.fpt", "a.pcd", {"--deadline-ms", "0.001"}, 1);
  EXPECT_EQ(found.at("status"), "deadline");
  EXPECT_EQ(found.at("search").at("exact"), false);
}

TEST_F(RoundTrip, PeopleGetATable) {
  learn(simulate("single", 3, "a.pcd"));
  const Ran ran = run({"locate", path("pad.fpt"), path("a.pcd")});
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("score"), std::string::npos);
  EXPECT_NE(ran.out.find("tilt"), std::string::npos);
  EXPECT_EQ(ran.err, "");
}

}  // namespace
}  // namespace flatpose::tool
