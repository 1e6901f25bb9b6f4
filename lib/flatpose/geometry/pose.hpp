#pragma once
// Rigid transforms. A pose names both frames so that neighbours cancel: p_scan_mm = scan_T_object *
// p_object_mm.

#include <array>

#include "flatpose/geometry/vec3.hpp"

namespace flatpose {

/// A rotation matrix by rows.
struct Rotation {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};

  [[nodiscard]] Vec3 column(int i) const noexcept { return {m[i], m[3 + i], m[6 + i]}; }
  [[nodiscard]] Rotation inverse() const noexcept {
    return {{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}};
  }
  friend Vec3 operator*(const Rotation& r, const Vec3& v) noexcept {
    return {r.m[0] * v.x + r.m[1] * v.y + r.m[2] * v.z, r.m[3] * v.x + r.m[4] * v.y + r.m[5] * v.z,
            r.m[6] * v.x + r.m[7] * v.y + r.m[8] * v.z};
  }
  friend Rotation operator*(const Rotation& a, const Rotation& b) noexcept;
};

struct Pose {
  Rotation rotation;
  Vec3 position_mm;

  [[nodiscard]] Pose inverse() const noexcept {
    const Rotation back = rotation.inverse();
    return {back, -(back * position_mm)};
  }
  friend Vec3 operator*(const Pose& pose, const Vec3& p_mm) noexcept {
    return pose.rotation * p_mm + pose.position_mm;
  }
  friend Pose operator*(const Pose& a, const Pose& b) noexcept {
    return {a.rotation * b.rotation, a * b.position_mm};
  }
};

/// Unit quaternion with w >= 0.
struct Quaternion {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

[[nodiscard]] Rotation rotation_about_z(double angle_rad) noexcept;
/// Turn by |v| about v.
[[nodiscard]] Rotation rotation_from_vector(const Vec3& rotation_vector_rad) noexcept;
/// The smallest rotation that takes z to `normal` (unit length, not -z): it tilts without turning.
[[nodiscard]] Rotation tilt_rotation(const Vec3& normal) noexcept;
/// The rotation whose columns are x, y, z for a unit z and an x direction that is projected onto
/// z's plane.
[[nodiscard]] Rotation rotation_from_z_and_x(const Vec3& z, const Vec3& x_direction) noexcept;
[[nodiscard]] Quaternion quaternion(const Rotation& rotation) noexcept;
/// The nearest rotation to a slightly drifted one (Gram-Schmidt from z, then x).
[[nodiscard]] Rotation orthonormalized(const Rotation& rotation) noexcept;
/// Angle of the rotation between the two, in [0, pi].
[[nodiscard]] double angle_between_rad(const Rotation& a, const Rotation& b) noexcept;

}  // namespace flatpose
