#include "flatpose/geometry/pose.hpp"

#include <algorithm>

#include "flatpose/core/maths.hpp"

namespace flatpose {

Rotation operator*(const Rotation& a, const Rotation& b) noexcept {
  Rotation product;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      product.m[3 * row + col] = a.m[3 * row] * b.m[col] + a.m[3 * row + 1] * b.m[3 + col] +
                                 a.m[3 * row + 2] * b.m[6 + col];
    }
  }
  return product;
}

Rotation rotation_about_z(double angle_rad) noexcept {
  const auto [s, c] = sin_cos(angle_rad);
  return {{c, -s, 0, s, c, 0, 0, 0, 1}};
}

Rotation rotation_from_vector(const Vec3& v) noexcept {
  const double angle_rad = norm(v);
  if (angle_rad < 1e-12) return {{1, -v.z, v.y, v.z, 1, -v.x, -v.y, v.x, 1}};
  const Vec3 k = (1.0 / angle_rad) * v;
  const auto [s, c] = sin_cos(angle_rad);
  const double t = 1.0 - c;
  return {{c + t * k.x * k.x, t * k.x * k.y - s * k.z, t * k.x * k.z + s * k.y,  //
           t * k.x * k.y + s * k.z, c + t * k.y * k.y, t * k.y * k.z - s * k.x,  //
           t * k.x * k.z - s * k.y, t * k.y * k.z + s * k.x, c + t * k.z * k.z}};
}

Rotation tilt_rotation(const Vec3& n) noexcept {
  // Rodrigues about z x n, with sin and cos eliminated: 1 / (1 + n.z) is all that is left of them.
  const double f = 1.0 / (1.0 + n.z);
  return {{1.0 - f * n.x * n.x, -f * n.x * n.y, n.x,  //
           -f * n.x * n.y, 1.0 - f * n.y * n.y, n.y,  //
           -n.x, -n.y, n.z}};
}

Rotation rotation_from_z_and_x(const Vec3& z, const Vec3& x_direction) noexcept {
  Vec3 x = x_direction - dot(x_direction, z) * z;
  if (norm(x) < 1e-9) x = cross(Vec3{0, 1, 0}, z);
  x = normalized(x);
  const Vec3 y = cross(z, x);
  return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
}

Quaternion quaternion(const Rotation& r) noexcept {
  const auto& m = r.m;
  // Shepperd: take the root of the largest of the four, so that nothing cancels.
  const double trace = m[0] + m[4] + m[8];
  Quaternion q;
  if (trace >= std::max({m[0], m[4], m[8]})) {
    const double s = 2.0 * std::sqrt(1.0 + trace);
    q = {s / 4.0, (m[7] - m[5]) / s, (m[2] - m[6]) / s, (m[3] - m[1]) / s};
  } else if (m[0] >= m[4] && m[0] >= m[8]) {
    const double s = 2.0 * std::sqrt(1.0 + m[0] - m[4] - m[8]);
    q = {(m[7] - m[5]) / s, s / 4.0, (m[1] + m[3]) / s, (m[2] + m[6]) / s};
  } else if (m[4] >= m[8]) {
    const double s = 2.0 * std::sqrt(1.0 + m[4] - m[0] - m[8]);
    q = {(m[2] - m[6]) / s, (m[1] + m[3]) / s, s / 4.0, (m[5] + m[7]) / s};
  } else {
    const double s = 2.0 * std::sqrt(1.0 + m[8] - m[0] - m[4]);
    q = {(m[3] - m[1]) / s, (m[2] + m[6]) / s, (m[5] + m[7]) / s, s / 4.0};
  }
  return q.w < 0.0 ? Quaternion{-q.w, -q.x, -q.y, -q.z} : q;
}

Rotation orthonormalized(const Rotation& r) noexcept {
  return rotation_from_z_and_x(normalized(r.column(2)), r.column(0));
}

double angle_between_rad(const Rotation& a, const Rotation& b) noexcept {
  // From the quaternion of a^-1 b: exact for small angles too, where the trace has lost its digits.
  const Quaternion q = quaternion(a.inverse() * b);
  return 2.0 * arc_tangent(norm(Vec3{q.x, q.y, q.z}), q.w);
}

}  // namespace flatpose
