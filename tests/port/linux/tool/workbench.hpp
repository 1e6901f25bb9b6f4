#pragma once
// The tool in process: a folder of its own, commands by their words, and small scans to work with.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "flatpose/geometry/pose.hpp"
#include "port/linux/daemon/config_map.hpp"
#include "port/linux/tool/tool.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::tool {

using Words = std::vector<std::string>;
using nlohmann::json;

struct Ran {
  int code = -1;
  std::string out;
  std::string err;
};

inline Ran run(const Words& words) {
  std::ostringstream out;
  std::ostringstream err;
  Ran ran;
  ran.code = run_tool(words, out, err, daemon::read_served_map);
  ran.out = out.str();
  ran.err = err.str();
  return ran;
}

/// The contract of failure: one line with a remedy, nothing on stdout.
inline void expect_refused(const Ran& ran, int code, const std::string& part = {}) {
  EXPECT_EQ(ran.code, code) << ran.err;
  EXPECT_EQ(ran.out, "");
  ASSERT_FALSE(ran.err.empty());
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_EQ(ran.err.back(), '\n');
  EXPECT_EQ(ran.err.rfind("flatpose: ", 0), 0U) << ran.err;
  port::expect_one_line(ran.err.substr(10, ran.err.size() - 11));
  EXPECT_NE(ran.err.find(part), std::string::npos) << "\"" << part << "\" is not in: " << ran.err;
}

inline Pose pose_of(const json& object) {
  Pose pose;
  const auto p = object.at("position_mm").get<std::vector<double>>();
  pose.position_mm = {p.at(0), p.at(1), p.at(2)};
  const auto m = object.at("rotation").get<std::vector<double>>();
  for (std::size_t i = 0; i < 9; ++i) pose.rotation.m[i] = m.at(i);
  return pose;
}

class Workbench : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }

  /// Simulates and returns the truth. 200 x 160 points at 2 mm keep the sanitizers' time short.
  json simulate(const std::string& scene, int seed, const std::string& name,
                const Words& more = {}) const {
    Words words{"--cols", "200", "--rows", "160", "--field-x-mm", "400", "--field-y-mm", "320"};
    words.insert(words.end(), more.begin(), more.end());
    return simulate_as(scene, seed, name, words);
  }
  json simulate_as(const std::string& scene, int seed, const std::string& name,
                   const Words& more) const {
    Words words{"simulate", scene,      "--seed",  std::to_string(seed),
                "-o",       path(name), "--truth", path(name + ".json")};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return read_json(name + ".json");
  }

  json teach(const std::string& scan, const std::string& part, const Words& more = {}) const {
    Words words{"teach", path(scan), "-o", path(part), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.code == 0 ? json::parse(ran.out) : json();
  }

  json locate(const std::string& part, const std::string& scan, const Words& more = {},
              int code = 0) const {
    Words words{"locate", path(part), path(scan), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, code) << ran.err;
    return ran.code <= 1 ? json::parse(ran.out) : json();
  }

  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] json read_json(const std::string& name) const { return json::parse(read(name)); }

  port::TemporaryFolder folder_;
};

}  // namespace flatpose::tool
