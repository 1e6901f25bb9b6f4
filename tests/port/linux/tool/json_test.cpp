// The objects that scripts rely on: every key, and the type of what stands there.

#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

void expect_numbers(const json& list, std::size_t count) {
  ASSERT_TRUE(list.is_array());
  ASSERT_EQ(list.size(), count);
  for (const json& value : list) EXPECT_TRUE(value.is_number());
}

void expect_pose(const json& object) {
  expect_numbers(object.at("position_mm"), 3);
  expect_numbers(object.at("rotation"), 9);
  expect_numbers(object.at("quaternion_wxyz"), 4);
  EXPECT_GE(object.at("quaternion_wxyz")[0].get<double>(), 0.0);
}

Words keys_of(const json& object) {
  Words keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

class Json : public Workbench {
 protected:
  void SetUp() override { simulate("single", 3, "a.pcd"); }
};

TEST_F(Json, OfLocateIsTheContracts) {
  teach("a.pcd", "pad.fpt", {"--name", "pad"});
  const json found = locate("pad.fpt", "a.pcd");
  EXPECT_EQ(keys_of(found), (Words{"digest", "frame", "matches", "memory", "part", "search",
                                   "status", "timings_us", "up", "up_reason"}));
  EXPECT_EQ(found.at("status"), "ok");
  EXPECT_EQ(found.at("frame"), "scan");
  EXPECT_EQ(found.at("up"), "+z");
  EXPECT_EQ(found.at("up_reason"), "viewpoint");
  EXPECT_EQ(found.at("part"), "pad");
  ASSERT_EQ(found.at("matches").size(), 1U);
  const json& match = found.at("matches")[0];
  expect_pose(match);
  expect_numbers(match.at("sigma_mm"), 3);
  expect_numbers(match.at("sigma_deg"), 3);
  for (const char* key : {"score", "visible", "edge_rms_mm", "surface_rms_mm"})
    EXPECT_TRUE(match.at(key).is_number()) << key;
  for (const char* key : {"load", "rectify", "features", "search", "refine", "verify", "total"})
    EXPECT_TRUE(found.at("timings_us").at(key).is_number_integer()) << key;
  EXPECT_GT(found.at("timings_us").at("total").get<int>(), 0);
  for (const char* key : {"hypotheses", "evaluated", "bound_gap"})
    EXPECT_TRUE(found.at("search").at(key).is_number()) << key;
  EXPECT_EQ(found.at("search").at("exact"), true);
  for (const char* key : {"arena_bytes", "peak_bytes"})
    EXPECT_GT(found.at("memory").at(key).get<std::int64_t>(), 0) << key;
  const std::string digest = found.at("digest");
  EXPECT_EQ(digest.size(), 16U);
  EXPECT_EQ(digest.find_first_not_of("0123456789abcdef"), std::string::npos);
}

TEST_F(Json, OfTeachAndInfoTellTheTemplate) {
  const json taught = teach("a.pcd", "pad.fpt");
  const json told = json::parse(run({"info", path("pad.fpt"), "--json"}).out);
  EXPECT_EQ(taught.at("name"), "pad");  // the output's stem
  EXPECT_EQ(told.at("kind"), "template");
  for (const char* key :
       {"threshold", "self_score", "rival_score", "contour_count", "surface_count", "cell_mm",
        "pitch_mm", "noise_mm", "step_mm", "radius_mm", "area_mm2"}) {
    EXPECT_TRUE(taught.at(key).is_number()) << key;
    EXPECT_EQ(taught.at(key), told.at(key)) << key;
  }
  EXPECT_EQ(taught.at("symmetry").at("order"), 1);
  ASSERT_FALSE(taught.at("anchors").empty());
  expect_numbers(taught.at("anchors")[0].at("position_mm"), 2);
  EXPECT_TRUE(taught.at("weakness").is_array());
  expect_pose(taught.at("taught_pose"));
  EXPECT_EQ(taught.at("taught_pose"), told.at("taught_pose"));
  EXPECT_EQ(taught.at("frame"), "scan");
  EXPECT_EQ(taught.at("up"), "+z");
  EXPECT_EQ(taught.at("up_reason"), "viewpoint");
  EXPECT_EQ(taught.at("scans_used"), 1);
}

TEST_F(Json, OfTeachDoubtsATurnThatDoesNotFit) {
  const auto doubts = [](const json& taught) {
    const json& all = taught.at("weakness");
    return std::any_of(all.begin(), all.end(),
                       [](const json& weak) { return weak.at("word") == "symmetry_doubtful"; });
  };
  EXPECT_FALSE(doubts(teach("a.pcd", "pad.fpt")));
  EXPECT_TRUE(doubts(teach("a.pcd", "pad.fpt", {"--symmetry", "3"})));
  const Ran told = run({"info", path("pad.fpt")});
  EXPECT_NE(told.out.find("--symmetry-center"), std::string::npos) << told.out;
}

// The middle of the pad is not its first anchor: what is told must not read as half its size.
TEST_F(Json, HasATextInWhichTheReachIsNoRadius) {
  const Ran taught = run({"teach", path("a.pcd"), "-o", path("pad.fpt")});
  for (const Ran& ran : {taught, run({"info", path("pad.fpt")})}) {
    EXPECT_NE(ran.out.find("mm from its first anchor"), std::string::npos) << ran.out;
    EXPECT_EQ(ran.out.find("radius"), std::string::npos) << ran.out;
  }
}

TEST_F(Json, OfInfoTellsScansAndWorkFiles) {
  const json scan = json::parse(run({"info", path("a.pcd"), "--json"}).out);
  EXPECT_EQ(scan.at("kind"), "scan");
  EXPECT_EQ(scan.at("simulated"), true);
  EXPECT_EQ(scan.at("width_px"), 200);
  EXPECT_EQ(scan.at("height_px"), 160);
  expect_numbers(scan.at("min_mm"), 3);
  expect_numbers(scan.at("max_mm"), 3);
  expect_numbers(scan.at("pitch_mm"), 2);
  EXPECT_NEAR(scan.at("pitch_mm")[0].get<double>(), 2.0, 0.05);
  EXPECT_NEAR(scan.at("noise_mm").get<double>(), 0.4, 0.1);
  EXPECT_NEAR(scan.at("min_mm")[0].get<double>(), -199.0, 2.0);
  EXPECT_LT(scan.at("missing_share").get<double>(), 0.1);
  EXPECT_EQ(json::parse(run({"info", path("a.pcd"), "--json", "--up", "-z"}).out).at("up"), "-z");

  ASSERT_EQ(run({"align", path("a.pcd"), "-o", path("work.json")}).code, 0);
  const json work = json::parse(run({"info", path("work.json"), "--json"}).out);
  EXPECT_EQ(work.at("kind"), "work");
  EXPECT_EQ(work.at("up"), "+z");
  expect_pose(work.at("work_T_scan"));
  for (const Words& words : {Words{"info", path("a.pcd")}, Words{"info", path("work.json")}}) {
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0);
    EXPECT_FALSE(ran.out.empty());
  }
}

TEST_F(Json, OfTestHasAVerdict) {
  teach("a.pcd", "pad.fpt");
  simulate("lone", 5, "b.pcd");
  const Ran ran = run({"test", path("pad.fpt"), path("a.pcd"), path("b.pcd"), "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const json told = json::parse(ran.out);
  EXPECT_TRUE(told.at("verdict").is_string());
  EXPECT_TRUE(told.at("verdict_sentence").is_string());
  ASSERT_EQ(told.at("scans").size(), 2U);
  for (const json& scan : told.at("scans")) {
    for (const char* key :
         {"score", "visible", "margin_over_threshold", "margin_over_rejected", "edge_rms_mm",
          "surface_rms_mm", "repeats", "position_spread_mm", "rotation_spread_deg"})
      EXPECT_TRUE(scan.at(key).is_number()) << key;
    EXPECT_EQ(scan.at("repeats"), 3);
    EXPECT_LT(scan.at("position_spread_mm").get<double>(), 0.5);
    EXPECT_LT(scan.at("rotation_spread_deg").get<double>(), 0.5);
  }
  EXPECT_NE(run({"test", path("pad.fpt"), path("a.pcd")}).out.find("verdict: "), std::string::npos);
}

TEST_F(Json, OfTruthIsTheContracts) {
  const json truth = read_json("a.pcd.json");
  EXPECT_EQ(keys_of(truth), (Words{"instances", "part", "scene", "seed"}));
  EXPECT_EQ(truth.at("scene"), "single");
  EXPECT_EQ(truth.at("seed"), 3);
  ASSERT_EQ(truth.at("instances").size(), 1U);
  const json& instance = truth.at("instances")[0];
  EXPECT_EQ(keys_of(instance), (Words{"part", "position_mm", "rotation", "visible"}));
  expect_numbers(instance.at("position_mm"), 3);
  expect_numbers(instance.at("rotation"), 9);
  EXPECT_GT(instance.at("visible").get<double>(), 0.9);
}

}  // namespace
}  // namespace flatpose::tool
