#include "port/linux/files/rigid_pose.hpp"

#include <cmath>

#include "port/linux/files/scan.hpp"

namespace flatpose::port {
namespace {

constexpr double kRotationTolerance = 1e-6;

}  // namespace

bool is_rotation(const Rotation& r) noexcept {
  const Rotation product = r * r.inverse();
  for (std::size_t i = 0; i < 9; ++i)
    if (!(std::fabs(product.m[i] - (i % 4 == 0 ? 1.0 : 0.0)) <= kRotationTolerance)) return false;
  return dot(cross(r.column(0), r.column(1)), r.column(2)) > 0.0;  // a mirror has -1
}

Pose read_pose(const JsonPlace& place, std::string_view remedy) {
  Pose pose;
  const JsonPlace position = place["position_mm"];
  double* position_mm[] = {&pose.position_mm.x, &pose.position_mm.y, &pose.position_mm.z};
  for (std::size_t i = 0; i < 3; ++i) {
    *position_mm[i] = position.element(i, 3).number();
    if (std::fabs(*position_mm[i]) > kCoordinateMax_mm)
      position.element(i, 3).fail("lies beyond +-1e6 mm", remedy);
  }
  const JsonPlace rotation = place["rotation"];
  for (std::size_t i = 0; i < 9; ++i) pose.rotation.m[i] = rotation.element(i, 9).number();
  if (!is_rotation(pose.rotation))
    rotation.fail("is no rotation (orthonormal, determinant +1)", remedy);
  return pose;
}

nlohmann::ordered_json pose_object(const Pose& pose) {
  nlohmann::ordered_json json;
  json["position_mm"] = {pose.position_mm.x, pose.position_mm.y, pose.position_mm.z};
  json["rotation"] = pose.rotation.m;
  return json;
}

}  // namespace flatpose::port
