#pragma once
// Where scans lie: on an aligned work plane (WORK.json), in the robot's frame (ROBOT.json), or
// neither. A job whose frame needs what could not be read has none, and no pose.

#include <cstdint>
#include <optional>
#include <string>

#include "flatpose/geometry/frames.hpp"
#include "flatpose/job/command.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::daemon {

struct Alignment {
  std::string work_file;  ///< Empty: none was named.
  std::string robot_file;
  std::optional<Pose> work_T_scan;
  port::Up work_up = port::Up::kMinusZ;  ///< The side of scans that the plane was aligned with.
  std::optional<Pose> robot_T_scan;
  std::uint32_t hash = 0;  ///< Of both files; 0: none is in use.
  std::string problem;     ///< Why there is not what the frame needs, or what was named; in a line.

  /// Whether poses of the frame can be told.
  [[nodiscard]] bool serves(job::FrameName frame) const noexcept;
  /// Of a scan with this side up.  Needs serves(frame).
  [[nodiscard]] Frames frames(job::FrameName frame, port::Up up) const noexcept;
};

/// Reads what is named; `up` is what the config says of all scans.  Fails: never, see problem.
[[nodiscard]] Alignment load_alignment(const std::string& work_file, const std::string& robot_file,
                                       job::FrameName frame, std::optional<port::Up> up);

}  // namespace flatpose::daemon
