#include "flatpose/geometry/robot_convention.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose {
namespace {

using Numbers = std::array<double, 4>;

std::vector<Convention> all_conventions() {
  std::vector<Convention> all;
  for (int i = 0; i < kConventionCount; ++i) all.push_back(static_cast<Convention>(i));
  return all;
}

class Random {  // SplitMix64
 public:
  double in(double low, double high) {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return low + (high - low) * static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  Rotation rotation() {
    for (;;) {
      const Vec3 v{in(-kPi, kPi), in(-kPi, kPi), in(-kPi, kPi)};
      if (norm(v) < kPi) return rotation_from_vector(v);
    }
  }

 private:
  std::uint64_t state_ = 7;
};

// The makers' definitions, written with libm and products of matrices of the test's own.
using Matrix = std::array<std::array<double, 3>, 3>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}
Matrix turn(char axis, double angle) {
  const double s = std::sin(angle), c = std::cos(angle);
  if (axis == 'x') return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
  if (axis == 'y') return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}
Matrix defined(Convention convention, const Numbers& v) {
  const auto three = [](char a, double x, char b, double y, char c, double z) {
    return product(product(turn(a, x), turn(b, y)), turn(c, z));
  };
  switch (convention) {
    case Convention::kKukaAbc: return three('z', v[0], 'y', v[1], 'x', v[2]);
    // W about the fixed x, then P about the fixed y, then R about the fixed z.
    case Convention::kFanucWpr:
      return product(turn('z', v[2]), product(turn('y', v[1]), turn('x', v[0])));
    case Convention::kStaubliXyz: return three('x', v[0], 'y', v[1], 'z', v[2]);
    case Convention::kZyz: return three('z', v[0], 'y', v[1], 'z', v[2]);
    case Convention::kUrRotationVector: {  // turn the vector's axis to z, turn, turn it back
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      const double azimuth = std::atan2(v[1], v[0]);
      const double polar = std::atan2(std::hypot(v[0], v[1]), v[2]);
      const Matrix there = product(turn('z', azimuth), turn('y', polar));
      const Matrix back = product(turn('y', -polar), turn('z', -azimuth));
      return product(product(there, turn('z', length)), back);
    }
    case Convention::kAbbQuaternion: {  // the sandwich q p q*, on each unit vector
      Matrix out{};
      for (int axis = 0; axis < 3; ++axis) {
        Numbers p{0, 0, 0, 0};
        p[axis + 1] = 1;
        const auto times = [](const Numbers& a, const Numbers& b) {
          return Numbers{a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                         a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                         a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                         a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
        };
        const Numbers turned = times(times(v, p), {v[0], -v[1], -v[2], -v[3]});
        for (int i = 0; i < 3; ++i) out[i][axis] = turned[i + 1];
      }
      return out;
    }
  }
  return {};
}

double distance(const Rotation& r, const Matrix& m) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += std::fabs(r.m[3 * i + j] - m[i][j]);
  return sum;
}

double distance(const Numbers& a, const Numbers& b) {
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

TEST(RobotConvention, NumbersGiveTheRotationBackByTheMakersOwnProducts) {
  Random random;
  for (int i = 0; i < 3000; ++i) {
    const Rotation r = random.rotation();
    for (const Convention convention : all_conventions()) {
      const RotationNumbers numbers = rotation_numbers(r, convention);
      EXPECT_LT(distance(r, defined(convention, numbers.value)), 1e-12) << to_string(convention);
      EXPECT_LT(angle_between_rad(rotation_from_numbers(numbers.value, convention), r), 1e-12);
      EXPECT_FALSE(numbers.is_singular);
    }
  }
}

TEST(RobotConvention, WithoutAReferenceNumbersStayInTheirRange) {
  Random random;
  for (int i = 0; i < 3000; ++i) {
    const Rotation r = random.rotation();
    for (const Convention convention : all_conventions()) {
      const Numbers v = rotation_numbers(r, convention).value;
      for (const double number : v) EXPECT_LE(std::fabs(number), kPi);
      if (convention == Convention::kUrRotationVector) {
        EXPECT_LE(norm(Vec3{v[0], v[1], v[2]}), kPi + 1e-12);
      }
      if (convention == Convention::kAbbQuaternion) {
        EXPECT_GE(v[0], 0.0);
      } else {
        EXPECT_EQ(v[3], 0.0);
      }
      EXPECT_TRUE(convention != Convention::kZyz || v[1] >= 0.0);
      const bool is_tilt = is_euler(convention) && convention != Convention::kZyz;
      EXPECT_TRUE(!is_tilt || std::fabs(v[1]) <= kPi / 2);
    }
  }
}

// Half turns are borders: +180 degrees is told, never -180.
TEST(RobotConvention, HalfTurnsArePositive) {
  const Rotation about_x = rotation_from_numbers({kPi, 0, 0, 0}, Convention::kFanucWpr);
  const Rotation about_z = rotation_from_numbers({kPi, 0, 0, 0}, Convention::kKukaAbc);
  EXPECT_NEAR(rotation_numbers(about_z, Convention::kKukaAbc).value[0], kPi, 1e-12);
  EXPECT_NEAR(rotation_numbers(about_z.inverse(), Convention::kStaubliXyz).value[2], kPi, 1e-12);
  EXPECT_NEAR(rotation_numbers(about_x, Convention::kFanucWpr).value[0], kPi, 1e-12);
}

TEST(RobotConvention, GimbalLockGivesTheRotationBackToo) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const double off_rad = i % 2 == 0 ? 0.0 : std::pow(10.0, random.in(-16, -6));
    for (const Convention convention : all_conventions()) {
      const double sign = random.in(-1, 1) < 0 ? -1.0 : 1.0;
      const double lock = convention == Convention::kZyz ? (sign < 0 ? 0.0 : kPi) : sign * kPi / 2;
      const Numbers made{random.in(-3, 3), lock + off_rad, random.in(-3, 3), 0.0};
      const Rotation r = rotation_from_numbers(made, convention);
      const Numbers reference{random.in(-9, 9), random.in(-9, 9), random.in(-9, 9), 0.0};
      for (const RotationNumbers& numbers :
           {rotation_numbers(r, convention), rotation_numbers(r, convention, reference)}) {
        const Rotation back = rotation_from_numbers(numbers.value, convention);
        EXPECT_LT(angle_between_rad(back, r), 3e-9) << to_string(convention) << " " << off_rad;
        EXPECT_TRUE(numbers.is_singular || off_rad != 0.0 || !is_euler(convention));
      }
    }
  }
}

TEST(RobotConvention, AtGimbalLockTheTurnIsAllInOneAngle) {
  struct Case {
    Convention convention;
    Numbers made;
    Numbers told;
  };
  const double q = kPi / 2;
  for (const Case& c : {Case{Convention::kKukaAbc, {0.5, q, 0.2, 0}, {0.3, q, 0, 0}},
                        Case{Convention::kKukaAbc, {0.5, -q, 0.2, 0}, {0.7, -q, 0, 0}},
                        Case{Convention::kFanucWpr, {0.2, q, 0.5, 0}, {0, q, 0.3, 0}},
                        Case{Convention::kStaubliXyz, {0.2, q, 0.5, 0}, {0, q, 0.7, 0}},
                        Case{Convention::kZyz, {0.5, 0, 0.2, 0}, {0.7, 0, 0, 0}},
                        Case{Convention::kZyz, {0.5, kPi, 0.2, 0}, {0.3, kPi, 0, 0}}}) {
    const auto numbers =
        rotation_numbers(rotation_from_numbers(c.made, c.convention), c.convention);
    EXPECT_LT(distance(numbers.value, c.told), 1e-9) << to_string(c.convention);
  }
}

// The oracle tries every branch: both of the Euler angles, each angle by whole turns; the vector's
// length by whole turns; both signs of the quaternion.
double nearest_by_force(const Rotation& r, Convention convention, const Numbers& reference) {
  const Numbers v = rotation_numbers(r, convention).value;
  double best = 1e9;
  const auto offer = [&](const Numbers& w) { best = std::min(best, distance(w, reference)); };
  if (convention == Convention::kAbbQuaternion) {
    offer(v);
    offer({-v[0], -v[1], -v[2], -v[3]});
    return best;
  }
  if (convention == Convention::kUrRotationVector) {
    const double length = norm(Vec3{v[0], v[1], v[2]});
    for (int k = -4; k <= 4; ++k) {
      const double f = 1.0 + 2 * kPi * k / length;
      offer({f * v[0], f * v[1], f * v[2], 0});
    }
    return best;
  }
  const double middle = convention == Convention::kZyz ? -v[1] : kPi - v[1];
  for (const Numbers& w : {v, Numbers{v[0] + kPi, middle, v[2] + kPi, 0}})
    for (int i = -3; i <= 3; ++i)
      for (int j = -3; j <= 3; ++j)
        for (int k = -3; k <= 3; ++k)
          offer({w[0] + 2 * kPi * i, w[1] + 2 * kPi * j, w[2] + 2 * kPi * k, 0});
  return best;
}

TEST(RobotConvention, TheBranchNearestTheReferenceIsTaken) {
  Random random;
  for (int i = 0; i < 400; ++i) {
    const Rotation r = random.rotation();
    const Numbers reference{random.in(-7, 7), random.in(-7, 7), random.in(-7, 7), 0.0};
    for (const Convention convention : all_conventions()) {
      const Numbers v = rotation_numbers(r, convention, reference).value;
      EXPECT_NEAR(distance(v, reference), nearest_by_force(r, convention, reference), 1e-9)
          << to_string(convention);
      EXPECT_LT(distance(r, defined(convention, v)), 1e-12);
    }
  }
}

// At the singularity no set of numbers of the same rotation is nearer: the free angle is tried in
// steps.
TEST(RobotConvention, AtGimbalLockTheFreeAngleComesNearestToo) {
  Random random;
  for (const Convention convention :
       {Convention::kKukaAbc, Convention::kFanucWpr, Convention::kStaubliXyz, Convention::kZyz}) {
    for (int i = 0; i < 40; ++i) {
      const double lock = convention == Convention::kZyz ? 0.0 : kPi / 2;
      const Numbers made{random.in(-3, 3), lock, random.in(-3, 3), 0.0};
      const Numbers reference{random.in(-3, 3), lock + random.in(-0.2, 0.2), random.in(-3, 3), 0};
      const Rotation r = rotation_from_numbers(made, convention);
      const double told = distance(rotation_numbers(r, convention, reference).value, reference);
      // R holds a - c for z-y'-x'', a + c for the other two.
      const double sign =
          convention == Convention::kKukaAbc || convention == Convention::kFanucWpr ? 1.0 : -1.0;
      double best = 1e9;
      for (int step = 0; step < 2000; ++step) {
        const double t = 4 * kPi * (step / 2000.0 - 0.5);
        for (int k = -1; k <= 1; ++k)
          best = std::min(
              best,
              distance({made[0] + t, made[1], made[2] + sign * t + 2 * kPi * k, 0}, reference));
      }
      EXPECT_LE(told, best + 1e-9) << to_string(convention);
    }
  }
}

// What the reference is for: a tool that looks down sits on the border of +-180 degrees.
TEST(RobotConvention, NoiseAboutABorderFlipsNoSign) {
  Random random;
  const Rotation down = rotation_from_vector({kPi, 0, 0});
  for (const Convention convention : all_conventions()) {
    const Numbers reference = rotation_numbers(down, convention).value;
    for (int i = 0; i < 500; ++i) {
      const Vec3 noise{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
      const Rotation seen = down * rotation_from_vector(1e-3 * noise);
      const Numbers v = rotation_numbers(seen, convention, reference).value;
      if (convention == Convention::kZyz) continue;  // singular here: not what it is for
      EXPECT_LT(distance(v, reference), 4e-3) << to_string(convention);
    }
  }
}

TEST(RobotConvention, NoTurnHasNoAxisButStaysNearItsReference) {
  const Numbers none = rotation_numbers({}, Convention::kUrRotationVector).value;
  EXPECT_EQ(distance(none, {}), 0.0);
  const Numbers whole = rotation_numbers({}, Convention::kUrRotationVector, {0, 0, 6.0, 0}).value;
  EXPECT_NEAR(distance(whole, {0, 0, 2 * kPi, 0}), 0.0, 1e-12);
}

TEST(RobotConvention, ZeroIsNoQuaternionAndGivesNoTurn) {
  const Rotation r = rotation_from_numbers({0, 0, 0, 0}, Convention::kAbbQuaternion);
  EXPECT_EQ(r.m, Rotation{}.m);
  const Rotation scaled = rotation_from_numbers({0, 0, 0, -3}, Convention::kAbbQuaternion);
  EXPECT_LT(distance(scaled, turn('z', kPi)), 1e-12);
}

TEST(RobotConvention, EachHasItsName) {
  std::vector<std::string> names;
  for (const Convention convention : all_conventions()) {
    for (const std::string& name : names) EXPECT_NE(name, to_string(convention));
    names.push_back(to_string(convention));
  }
  EXPECT_STREQ(to_string(static_cast<Convention>(99)), "unknown");
}

}  // namespace
}  // namespace flatpose
