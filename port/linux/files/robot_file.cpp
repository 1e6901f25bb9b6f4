#include "port/linux/files/robot_file.hpp"

#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include "flatpose/core/fnv.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/rigid_pose.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {
namespace {

constexpr const char* kFormat = "flatpose-robot";
constexpr std::uint64_t kVersion = 1;
constexpr std::int64_t kFileBytesMax = 16 * 1024 * 1024;
constexpr const char* kAlignAgain = "write it again with flatpose align --touch";

std::string hash_of(const Pose& pose) {
  Fnv1a64 hash;
  for (const double number : {pose.position_mm.x, pose.position_mm.y, pose.position_mm.z})
    hash.add(number);
  for (const double number : pose.rotation.m) hash.add(number);
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016" PRIx64, hash.value());
  return text.data();
}

double read_length(const JsonPlace& place) {
  const double value = place.number();
  if (value < 0.0) place.fail("is below 0", kAlignAgain);
  return value;
}

nlohmann::ordered_json numbers(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

RobotFile read_robot_file(const std::string& path) {
  const nlohmann::json json = parse_json(path, read_file(path, kFileBytesMax));
  const JsonPlace top(path, json);
  if (!top.has("format") || !json["format"].is_string() || json["format"] != kFormat)
    top.fail("is no robot file", "write one with flatpose align --touch");
  if (const std::uint64_t version = top["version"].whole_number(); version != kVersion)
    top["version"].fail(std::to_string(version) + " is not the known " + std::to_string(kVersion),
                        version > kVersion ? "use a newer flatpose" : kAlignAgain);
  RobotFile robot;
  robot.robot_T_scan = read_pose(top["robot_T_scan"], kAlignAgain);
  if (top.has("hash") && top["hash"].text() != hash_of(robot.robot_T_scan))
    top["hash"].fail("is not that of robot_T_scan: the pose was changed by hand",
                     "align again, or take the hash out if the change is meant");
  if (top.has("quality")) {
    const JsonPlace quality = top["quality"];
    robot.quality = RobotQuality{read_length(quality["rms_mm"]), read_length(quality["worst_mm"]),
                                 read_length(quality["leave_one_out_mm"])};
  }
  return robot;
}

void write_robot_file(const std::string& path, const RobotFile& robot) {
  // JSON has no NaN: what is written here must be readable there.
  if (!(norm(robot.robot_T_scan.position_mm) <= kCoordinateMax_mm) ||
      !is_rotation(robot.robot_T_scan.rotation))
    throw InputError(path, "the pose to write is no finite rigid pose", "check the touched points");
  nlohmann::ordered_json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["robot_T_scan"] = pose_object(robot.robot_T_scan);
  json["hash"] = hash_of(robot.robot_T_scan);
  if (robot.quality)
    json["quality"] = {{"rms_mm", robot.quality->rms_mm},
                       {"worst_mm", robot.quality->worst_mm},
                       {"leave_one_out_mm", robot.quality->leave_one_out_mm}};
  if (!robot.pairs.empty()) json["pairs"] = nlohmann::ordered_json::array();
  for (const TouchedPair& pair : robot.pairs)
    json["pairs"].push_back({{"line", pair.line},
                             {"scan_mm", numbers(pair.scan_mm)},
                             {"robot_mm", numbers(pair.robot_mm)},
                             {"residual_mm", pair.residual_mm}});
  write_file_atomically(path, json.dump(2) + "\n");
}

}  // namespace flatpose::port
