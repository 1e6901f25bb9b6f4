#pragma once
// What a daemon's config makes of the register map: how numbers lie in registers, which node it is
// on CAN, and which jobs there are.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flatpose/can/config.hpp"
#include "flatpose/geometry/robot_convention.hpp"
#include "flatpose/job/rules.hpp"
#include "flatpose/result_map/registers.hpp"

namespace flatpose::tool {

struct ServedJob {
  int number = 1;
  std::string parts;  ///< Their names, "pad, disc".
  job::FrameName frame = job::FrameName::kScan;
  Convention convention = Convention::kKukaAbc;
};

/// As it is, the map of no config in particular.
struct ServedMap {
  std::string config_path;  ///< Empty: none.
  result_map::WireFormat format;
  job::Handshake handshake = job::Handshake::kNumber;
  int node = can::Config{}.node;
  int fd_frame_id = 0;  ///< 0: the usual.
  std::vector<ServedJob> jobs;
};

/// Reads a config.  Fails: port::InputError.
using ReadServedMap = std::function<ServedMap(const std::string& config_path)>;

/// "ABCD"
[[nodiscard]] const char* name_of(result_map::WordOrder order);

/// What an int32 rotation is worth.
struct RotationMeasure {
  double scale = 0.001;
  const char* unit = "deg";
  friend bool operator==(const RotationMeasure& a, const RotationMeasure& b) {
    return a.scale == b.scale && std::string_view(a.unit) == b.unit;
  }
};
[[nodiscard]] RotationMeasure rotation_measure(Convention convention);

/// The one that all jobs share; none: jobs differ, or there are none.
[[nodiscard]] std::optional<RotationMeasure> rotation_measure_of(const ServedMap& served);

/// "pad; frame scan, kuka_abc"
[[nodiscard]] std::string text_of(const ServedJob& job);

}  // namespace flatpose::tool
