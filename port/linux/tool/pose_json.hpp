#pragma once
// Poses and numbers as the tool's JSON has them. It pulls nlohmann-json in: for this folder's .cpp
// files.

#include <nlohmann/json.hpp>
#include <string>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/model/template.hpp"

namespace flatpose::tool {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json json_of(const Vec3& v);
/// Adds position_mm, rotation and quaternion_wxyz to `object`.
void add_pose(Json& object, const Pose& pose);
/// All that is told of a template, by teach and by info.
[[nodiscard]] Json json_of(const model::Template& part);
/// One object in one line; bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string line_of(const Json& json);

}  // namespace flatpose::tool
