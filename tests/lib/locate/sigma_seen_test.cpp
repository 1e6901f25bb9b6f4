// Sigma of other points of a part, against many perturbed poses.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "flatpose/locate/sigma.hpp"

namespace flatpose::locate {
namespace {

using Six = std::array<double, 6>;

/// A factor of a covariance: turns of hundredths, shifts of tenths, all mixed.
struct Scatter {
  std::array<Six, 6> factor{};

  explicit Scatter(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j <= i; ++j) factor[i][j] = (i < 3 ? 1e-3 : 0.1) * normal(random);
  }
  [[nodiscard]] double covariance(int i, int j) const {
    double sum = 0.0;
    for (int k = 0; k < 6; ++k) sum += factor[i][k] * factor[j][k];
    return sum;
  }
  [[nodiscard]] Six drawn(std::mt19937& random) const {
    std::normal_distribution<double> normal;
    Six free{}, out{};
    for (double& x : free) x = normal(random);
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < 6; ++k) out[i] += factor[i][k] * free[k];
    return out;
  }
};

Match match_with(const Scatter& scatter) {
  Match match;
  match.face_T_object = {rotation_from_vector({0.3, -0.7, 1.1}), {100, 50, -20}};
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j)
      match.covariance[at++] = static_cast<float>(scatter.covariance(i, j));
  return match;
}

TEST(SigmaSeen, IsTheScatterOfPerturbedPoses) {
  constexpr int kDraws = 4000;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Scatter scatter(seed);
    const Match match = match_with(scatter);
    const Pose object_T_pick{rotation_from_vector({2.8, 0.2 * seed, -0.4}), {80, -35, 10}};
    const Sigma sigma = sigma_of(match, object_T_pick);
    const Pose face_T_pick = match.face_T_object * object_T_pick;
    std::mt19937 random(77 + seed);
    Six squares{};
    for (int n = 0; n < kDraws; ++n) {
      const Six d = scatter.drawn(random);
      const Pose moved{rotation_from_vector({d[0], d[1], d[2]}), {d[3], d[4], d[5]}};
      const Pose other = match.face_T_object * moved * object_T_pick;
      const Vec3 shift = other.position_mm - face_T_pick.position_mm;
      const Rotation turn = face_T_pick.rotation.inverse() * other.rotation;
      const Six off{shift.x,
                    shift.y,
                    shift.z,
                    0.5 * (turn.m[7] - turn.m[5]),
                    0.5 * (turn.m[2] - turn.m[6]),
                    0.5 * (turn.m[3] - turn.m[1])};
      for (int i = 0; i < 6; ++i) squares[i] += off[i] * off[i] / kDraws;
    }
    const Six told{sigma.mm.x, sigma.mm.y, sigma.mm.z, sigma.rad.x, sigma.rad.y, sigma.rad.z};
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(told[i] / std::sqrt(squares[i]), 1.0, 0.06) << "seed " << seed << " axis " << i;
  }
}

TEST(SigmaSeen, OfNothingIsNothingAndNeverNaN) {
  const Sigma sigma = sigma_of(Match{}, {rotation_from_vector({1, 2, 3}), {1000, 1000, 1000}});
  EXPECT_EQ(sigma.mm.x, 0.0);
  EXPECT_EQ(sigma.rad.z, 0.0);
  Match rounded;  // one turn alone, in floats: rounding leaves variances a little off
  rounded.covariance[0] = 1e-6F;
  for (int i = 0; i < 50; ++i) {
    const Sigma seen =
        sigma_of(rounded, {rotation_from_vector({0.1 * i, 1, 0}), {300.0 * i, 7, 1}});
    for (const double value : {seen.mm.x, seen.mm.y, seen.mm.z, seen.rad.x, seen.rad.y, seen.rad.z})
      EXPECT_TRUE(value >= 0.0 && std::isfinite(value));
  }
}

}  // namespace
}  // namespace flatpose::locate
