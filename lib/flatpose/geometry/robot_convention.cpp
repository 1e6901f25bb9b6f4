#include "flatpose/geometry/robot_convention.hpp"

#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose {
namespace {

using Numbers = std::array<double, 4>;

constexpr double kTurn_rad = 2.0 * kPi;

// Angles of a product of three turns, outer first.
struct Triple {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
};

// In (-pi, pi].
double canonical(double angle_rad) noexcept {
  const double wrapped = wrap_angle(angle_rad);
  return wrapped <= -kPi ? wrapped + kTurn_rad : wrapped;
}

double near(double angle_rad, double reference_rad) noexcept {
  return reference_rad + wrap_angle(angle_rad - reference_rad);
}

double square(double x) noexcept { return x * x; }

// One kind of Euler angles: what of R gives them. c always follows from R and a, so that the three
// give R back however near the singularity is.
struct Zyx {
  static constexpr double kMiddle_rad = kPi;  // the other branch is (a + pi, pi - b, c + pi)
  static double spread(const Rotation& r) noexcept {
    return std::sqrt(square(r.m[0]) + square(r.m[3]));  // |cos b|
  }
  static double outer(const Rotation& r) noexcept { return arc_tangent(r.m[3], r.m[0]); }
  static double middle(const Rotation& r) noexcept { return arc_tangent(-r.m[6], spread(r)); }
  static double inner(const Rotation& r, double a) noexcept {
    const auto [s, c] = sin_cos(a);
    return arc_tangent(s * r.m[2] - c * r.m[5], c * r.m[4] - s * r.m[1]);
  }
  // Where singular: whether c grows with a (a - c is held) or falls (a + c is).
  static double follows(const Rotation& r) noexcept { return r.m[6] < 0.0 ? 1.0 : -1.0; }
};

struct Zyz {
  static constexpr double kMiddle_rad = 0.0;  // the other branch is (a + pi, -b, c + pi)
  static double spread(const Rotation& r) noexcept {
    return std::sqrt(square(r.m[2]) + square(r.m[5]));  // |sin b|
  }
  static double outer(const Rotation& r) noexcept { return arc_tangent(r.m[5], r.m[2]); }
  static double middle(const Rotation& r) noexcept { return arc_tangent(spread(r), r.m[8]); }
  static double inner(const Rotation& r, double a) noexcept {
    const auto [s, c] = sin_cos(a);
    return arc_tangent(c * r.m[3] - s * r.m[0], c * r.m[4] - s * r.m[1]);
  }
  static double follows(const Rotation& r) noexcept { return r.m[8] > 0.0 ? -1.0 : 1.0; }
};

double distance2(const Triple& t, const Triple& reference) noexcept {
  return square(t.a - reference.a) + square(t.b - reference.b) + square(t.c - reference.c);
}

Triple near(const Triple& t, const Triple& reference) noexcept {
  return {near(t.a, reference.a), near(t.b, reference.b), near(t.c, reference.c)};
}

// The free angle is shared out between a and c, so that both are equally far from the reference.
template <class Kind>
Triple singular_near(const Rotation& r, double a0, const Triple& reference) noexcept {
  const double lag = wrap_angle(Kind::inner(r, a0) - reference.c);
  const double a = a0 - Kind::follows(r) * 0.5 * lag;
  return near({a, Kind::middle(r), Kind::inner(r, a)}, reference);
}

template <class Kind>
Triple angles_near(const Rotation& r, const Triple& reference, bool& is_singular) noexcept {
  is_singular = Kind::spread(r) < kSingularSine;
  Triple first{Kind::outer(r), Kind::middle(r), 0.0};
  if (is_singular) {
    first = singular_near<Kind>(r, reference.a, reference);
  } else {
    first.c = Kind::inner(r, first.a);
  }
  const Triple one = near(first, reference);
  const Triple other =
      near(Triple{first.a + kPi, Kind::kMiddle_rad - first.b, first.c + kPi}, reference);
  return distance2(other, reference) < distance2(one, reference) ? other : one;
}

template <class Kind>
Triple angles(const Rotation& r, bool& is_singular) noexcept {
  is_singular = Kind::spread(r) < kSingularSine;
  // With c = 0 all the turn is a's: what inner() would find is taken back.
  double a = is_singular ? -Kind::follows(r) * Kind::inner(r, 0.0) : Kind::outer(r);
  a = canonical(a);
  return {a, Kind::middle(r), is_singular ? 0.0 : canonical(Kind::inner(r, a))};
}

template <class Kind>
Triple solve(const Rotation& r, const Triple* reference, bool& is_singular) noexcept {
  return reference != nullptr ? angles_near<Kind>(r, *reference, is_singular)
                              : angles<Kind>(r, is_singular);
}

RotationNumbers euler(const Rotation& r, Convention convention, const Numbers* near_to) noexcept {
  RotationNumbers out;
  Numbers& v = out.value;
  const Numbers ref = near_to != nullptr ? *near_to : Numbers{};
  const auto given = [near_to](const Triple& t) { return near_to != nullptr ? &t : nullptr; };
  const Triple as_is{ref[0], ref[1], ref[2]};
  const Triple backwards{ref[2], ref[1], ref[0]};
  const Triple inverse{-ref[2], -ref[1], -ref[0]};
  if (convention == Convention::kFanucWpr) {
    const Triple t = solve<Zyx>(r, given(backwards), out.is_singular);
    v = {t.c, t.b, t.a, 0.0};
  } else if (convention == Convention::kStaubliXyz) {
    // Rx(a) Ry(b) Rz(c) is the inverse of Rz(-c) Ry(-b) Rx(-a).
    const Triple t = solve<Zyx>(r.inverse(), given(inverse), out.is_singular);
    v = {0.0 - t.c, 0.0 - t.b, 0.0 - t.a, 0.0};
    if (near_to == nullptr) v = {canonical(v[0]), v[1], canonical(v[2]), 0.0};
  } else if (convention == Convention::kZyz) {
    const Triple t = solve<Zyz>(r, given(as_is), out.is_singular);
    v = {t.a, t.b, t.c, 0.0};
  } else {
    const Triple t = solve<Zyx>(r, given(as_is), out.is_singular);
    v = {t.a, t.b, t.c, 0.0};
  }
  return out;
}

RotationNumbers rotation_vector(const Rotation& r, const Numbers* near_to) noexcept {
  const Quaternion q = quaternion(r);
  const Vec3 u{q.x, q.y, q.z};
  const double sine = norm(u);
  const Vec3 ref = near_to != nullptr ? Vec3{(*near_to)[0], (*near_to)[1], (*near_to)[2]} : Vec3{};
  RotationNumbers out;
  out.is_singular = sine < kSingularSine;
  const double angle_rad = 2.0 * arc_tangent(sine, q.w);
  // Next to no turn has no axis: any will do, and the reference's is the nearest.
  const bool has_axis = !out.is_singular || norm(ref) < kPi;
  const Vec3 axis = has_axis ? (sine > 0.0 ? (1.0 / sine) * u : Vec3{}) : normalized(ref);
  double length_rad = has_axis ? angle_rad : 0.0;
  if (near_to != nullptr) {
    length_rad += kTurn_rad * std::floor((dot(ref, axis) - length_rad) / kTurn_rad + 0.5);
  }
  const Vec3 v = length_rad * axis;
  out.value = {v.x, v.y, v.z, 0.0};
  return out;
}

RotationNumbers quaternion_numbers(const Rotation& r, const Numbers* near_to) noexcept {
  const Quaternion q = quaternion(r);
  Numbers v{q.w, q.x, q.y, q.z};
  double likeness = 0.0;
  for (int i = 0; near_to != nullptr && i < 4; ++i) likeness += v[i] * (*near_to)[i];
  if (likeness < 0.0) v = {-q.w, -q.x, -q.y, -q.z};
  return {v, false};
}

RotationNumbers numbers(const Rotation& r, Convention convention, const Numbers* near_to) noexcept {
  if (convention == Convention::kUrRotationVector) return rotation_vector(r, near_to);
  if (convention == Convention::kAbbQuaternion) return quaternion_numbers(r, near_to);
  return euler(r, convention, near_to);
}

Rotation about_x(double angle_rad) noexcept {
  const auto [s, c] = sin_cos(angle_rad);
  return {{1, 0, 0, 0, c, -s, 0, s, c}};
}
Rotation about_y(double angle_rad) noexcept {
  const auto [s, c] = sin_cos(angle_rad);
  return {{c, 0, s, 0, 1, 0, -s, 0, c}};
}

Rotation from_quaternion(const Numbers& v) noexcept {
  const double length = std::sqrt(square(v[0]) + square(v[1]) + square(v[2]) + square(v[3]));
  if (!(length > 0.0)) return {};
  const double w = v[0] / length, x = v[1] / length, y = v[2] / length, z = v[3] / length;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
           2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),  //
           2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

}  // namespace

const char* to_string(Convention convention) noexcept {
  switch (convention) {
    case Convention::kKukaAbc: return "kuka_abc";
    case Convention::kFanucWpr: return "fanuc_wpr";
    case Convention::kUrRotationVector: return "ur_rotation_vector";
    case Convention::kAbbQuaternion: return "abb_quaternion";
    case Convention::kStaubliXyz: return "staubli_xyz";
    case Convention::kZyz: return "zyz";
  }
  return "unknown";
}

RotationNumbers rotation_numbers(const Rotation& rotation, Convention convention) noexcept {
  return numbers(rotation, convention, nullptr);
}

RotationNumbers rotation_numbers(const Rotation& rotation, Convention convention,
                                 const std::array<double, 4>& reference) noexcept {
  return numbers(rotation, convention, &reference);
}

Rotation rotation_from_numbers(const std::array<double, 4>& v, Convention convention) noexcept {
  switch (convention) {
    case Convention::kKukaAbc: return rotation_about_z(v[0]) * about_y(v[1]) * about_x(v[2]);
    case Convention::kFanucWpr: return rotation_about_z(v[2]) * about_y(v[1]) * about_x(v[0]);
    case Convention::kUrRotationVector: return rotation_from_vector({v[0], v[1], v[2]});
    case Convention::kAbbQuaternion: return from_quaternion(v);
    case Convention::kStaubliXyz: return about_x(v[0]) * about_y(v[1]) * rotation_about_z(v[2]);
    case Convention::kZyz: return rotation_about_z(v[0]) * about_y(v[1]) * rotation_about_z(v[2]);
  }
  return {};
}

}  // namespace flatpose
