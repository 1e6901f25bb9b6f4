#pragma once
// Rotations as users write them: in a robot's numbers, degrees where these are angles.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "flatpose/geometry/robot_convention.hpp"
#include "port/linux/daemon/section.hpp"

namespace flatpose::daemon {

/// "kuka_abc", "fanuc_wpr", ... in the order of the enumeration.
[[nodiscard]] std::vector<std::string> convention_words();

/// The numbers under `key`, rad or a quaternion, three of them or four.  Fails: port::InputError.
[[nodiscard]] std::optional<std::array<double, 4>> read_rotation_numbers(Section& section,
                                                                         const std::string& key,
                                                                         Convention convention);

}  // namespace flatpose::daemon
