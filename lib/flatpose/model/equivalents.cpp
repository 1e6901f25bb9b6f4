#include "flatpose/model/equivalents.hpp"

#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose::model {

Pose turned_about_symmetry(const Pose& face_T_object, const Symmetry& symmetry,
                           double angle_rad) noexcept {
  const Rotation turn = rotation_about_z(angle_rad);
  const Vec3 center_mm{symmetry.center_x_mm, symmetry.center_y_mm, 0.0};
  return face_T_object * Pose{turn, center_mm - turn * center_mm};
}

double turn_to_face_x_rad(const Rotation& face_R_object) noexcept {
  // The face's x seen from the object is the first row of the rotation.
  return arc_tangent(face_R_object.m[1], face_R_object.m[0]);
}

Pose canonical_equivalent(const Pose& face_T_object, const Symmetry& symmetry) noexcept {
  if (symmetry.order == 1) return face_T_object;
  const double turn_rad = turn_to_face_x_rad(face_T_object.rotation);
  if (symmetry.order == kFullSymmetry)
    return turned_about_symmetry(face_T_object, symmetry, turn_rad);
  const double step_rad = 2.0 * kPi / symmetry.order;
  const double steps = std::floor(turn_rad / step_rad + 0.5);
  return turned_about_symmetry(face_T_object, symmetry, steps * step_rad);
}

}  // namespace flatpose::model
