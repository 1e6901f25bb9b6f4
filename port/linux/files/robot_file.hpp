#pragma once
// ROBOT.json: where the scan lies in the robot's frame, as `align --touch` found it, or as another
// calibration did (then the first three lines are enough):
// {"format":"flatpose-robot","version":1,
//  "robot_T_scan":{"position_mm":[3],"rotation":[9 numbers, row by row]},
//  "hash":"16 hex digits, FNV-1a 64 over the 12 numbers: a pose that was changed by hand is
//  refused", "quality":{"rms_mm":..,"worst_mm":..,"leave_one_out_mm":..},
//  "pairs":[{"line":..,"scan_mm":[3],"robot_mm":[3],"residual_mm":..},..]}

#include <optional>
#include <string>
#include <vector>

#include "flatpose/geometry/pose.hpp"

namespace flatpose::port {

/// How well the touched points fit.
struct RobotQuality {
  double rms_mm = 0.0;
  double worst_mm = 0.0;
  /// Of points that were left out of the fit: what a pick may be off by; 0: none could be.
  double leave_one_out_mm = 0.0;
};

struct TouchedPair {
  int line = 0;  ///< Of the file of pairs.
  Vec3 scan_mm;
  Vec3 robot_mm;
  double residual_mm = 0.0;
};

struct RobotFile {
  Pose robot_T_scan;
  std::optional<RobotQuality> quality;
  std::vector<TouchedPair> pairs;
};

/// The pairs of the file are for people: they are not read.  Fails: InputError.
[[nodiscard]] RobotFile read_robot_file(const std::string& path);
/// Numbers are written so that they read back the same.  Fails: InputError; nothing is left then.
void write_robot_file(const std::string& path, const RobotFile& robot);

}  // namespace flatpose::port
