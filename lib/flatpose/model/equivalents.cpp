#include "flatpose/model/equivalents.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose::model {
namespace {

/// A direction of the object that turns with it, seen along two axes in the face's xy plane.
class Pointer {
 public:
  Pointer(const Rotation& face_R_object, const Vec3& told, double angle_rad) noexcept
      : face_R_object_(face_R_object), told_(told) {
    const auto [s, c] = sin_cos(angle_rad);
    along_ = {c, s, 0.0};
    across_ = {-s, c, 0.0};
  }

  /// How far off the wanted angle it points after this turn, in [0, pi].
  [[nodiscard]] double off_rad(double turn_rad) const noexcept {
    const Vec3 seen = face_R_object_ * (rotation_about_z(turn_rad) * told_);
    return std::fabs(arc_tangent(dot(across_, seen), dot(along_, seen)));
  }

  /// The turn that lets it point there. What lies across is a + b cos t + c sin t; of its two zeros
  /// one points there and one the other way. Where it has none, the turn that comes nearest to one.
  [[nodiscard]] double turn_rad() const noexcept {
    const Vec3 x{told_.x, told_.y, 0.0};
    const Vec3 y{-told_.y, told_.x, 0.0};
    const double a = dot(across_, face_R_object_ * Vec3{0.0, 0.0, told_.z});
    const double b = dot(across_, face_R_object_ * x);
    const double c = dot(across_, face_R_object_ * y);
    const double length = std::sqrt(b * b + c * c);
    if (!(length > 0.0)) return 0.0;
    const double middle_rad = arc_tangent(c, b);
    const double spread_rad = arc_cosine(std::clamp(-a / length, -1.0, 1.0));
    const double one = wrap_angle(middle_rad + spread_rad);
    const double other = wrap_angle(middle_rad - spread_rad);
    return off_rad(one) <= off_rad(other) ? one : other;
  }

 private:
  Rotation face_R_object_;
  Vec3 told_;
  Vec3 along_;
  Vec3 across_;
};

}  // namespace

double turn_to_angle_rad(const Rotation& face_R_object, const Symmetry& symmetry,
                         const Rotation& object_R_told, double angle_rad) noexcept {
  const Pointer pointer(face_R_object, object_R_told.column(0), angle_rad);
  if (symmetry.order == kFullSymmetry) return pointer.turn_rad();
  double best_rad = 0.0;
  double best_off_rad = pointer.off_rad(0.0);
  for (int i = 1; i < symmetry.order; ++i) {
    const double turn_rad = 2.0 * kPi * i / symmetry.order;
    const double off_rad = pointer.off_rad(turn_rad);
    if (off_rad >= best_off_rad) continue;
    best_rad = turn_rad;
    best_off_rad = off_rad;
  }
  return best_rad;
}

Pose told_at_angle(const Rotation& face_R_object, const Symmetry& symmetry,
                   const Pose& object_T_told, double angle_rad) noexcept {
  if (symmetry.order == 1) return object_T_told;
  const double turn_rad =
      turn_to_angle_rad(face_R_object, symmetry, object_T_told.rotation, angle_rad);
  return turned_about_symmetry({}, symmetry, turn_rad) * object_T_told;
}

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
