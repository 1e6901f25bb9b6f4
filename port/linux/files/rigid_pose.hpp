#pragma once
// A rigid pose in a JSON file: {"position_mm":[3],"rotation":[9 numbers, row by row]}. For this
// folder's .cpp files only.

#include <string>

#include "flatpose/geometry/pose.hpp"
#include "port/linux/files/json_text.hpp"

namespace flatpose::port {

/// Orthonormal within 1e-6, determinant +1.
[[nodiscard]] bool is_rotation(const Rotation& rotation) noexcept;

/// Fails: InputError with `remedy`.
[[nodiscard]] Pose read_pose(const JsonPlace& place, std::string_view remedy);
[[nodiscard]] nlohmann::ordered_json pose_object(const Pose& pose);

}  // namespace flatpose::port
