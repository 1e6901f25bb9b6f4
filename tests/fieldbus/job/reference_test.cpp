// With a reference, noise about a border of the conventions' numbers flips no sign.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "flatpose/core/maths.hpp"
#include "flatpose/job/result_board.hpp"

namespace flatpose::job {
namespace {

using Numbers = std::array<double, 4>;

/// What a master reads of this rotation.
Numbers shown(const Rotation& rotation, const JobRule& rule) {
  ScanResult result;
  result.answer = Answer::kOk;
  result.has_scan = true;
  result.match_count = 1;
  result.matches[0].frame_T_pick.rotation = rotation;
  ResultBoard board;
  board.post_scan(1, 1, rule, result);
  Snapshot snapshot;
  board.show(0, 1, snapshot);
  return snapshot.match.rotation;
}

/// The greatest step of any number while the pose trembles about a border.
double greatest_spread(const Rotation& border, const JobRule& rule, double& worst_off_rad) {
  std::mt19937 random(9);
  std::normal_distribution<double> tremble(0.0, 1e-3);
  Numbers low, high;
  low.fill(1e9);
  high.fill(-1e9);
  for (int i = 0; i < 2000; ++i) {
    const Rotation pose =
        border * rotation_from_vector({tremble(random), tremble(random), tremble(random)});
    const Numbers numbers = shown(pose, rule);
    for (int k = 0; k < 4; ++k) {
      low[k] = std::min(low[k], numbers[k]);
      high[k] = std::max(high[k], numbers[k]);
    }
    worst_off_rad = std::max(
        worst_off_rad, angle_between_rad(rotation_from_numbers(numbers, rule.convention), pose));
  }
  double spread = 0.0;
  for (int k = 0; k < 4; ++k) spread = std::max(spread, high[k] - low[k]);
  return spread;
}

struct Border {
  Convention convention;
  Numbers numbers;  // where some number is at its border
};
constexpr Border kBorders[] = {{Convention::kKukaAbc, {0.4, 0.1, kPi, 0}},
                               {Convention::kKukaAbc, {kPi, 0.2, 0.3, 0}},
                               {Convention::kFanucWpr, {kPi, 0.1, -0.7, 0}},
                               {Convention::kFanucWpr, {-kPi, 0.3, kPi, 0}},
                               {Convention::kStaubliXyz, {kPi, 0.1, 1, 0}},
                               {Convention::kStaubliXyz, {0.2, -0.3, -kPi, 0}},
                               {Convention::kZyz, {kPi, 0.8, 0.5, 0}},
                               {Convention::kZyz, {0.5, 2.0, -kPi, 0}},
                               {Convention::kUrRotationVector, {kPi, 0, 0, 0}},
                               {Convention::kUrRotationVector, {0, -kPi, 0, 0}},
                               {Convention::kAbbQuaternion, {0, 1, 0, 0}},
                               {Convention::kAbbQuaternion, {0, 0.6, -0.8, 0}}};

TEST(ReferenceRotation, KeepsSignsWhereNoiseWouldFlipThem) {
  for (const Border& border : kBorders) {
    SCOPED_TRACE(to_string(border.convention));
    const Rotation rotation = rotation_from_numbers(border.numbers, border.convention);
    JobRule rule;
    rule.convention = border.convention;
    double off_rad = 0.0;
    // Without one the noise does flip them.
    EXPECT_GT(greatest_spread(rotation, rule, off_rad), 1.0);
    rule.has_reference = true;
    rule.reference = border.numbers;
    EXPECT_LT(greatest_spread(rotation, rule, off_rad), 0.05);
    // A reference that is only roughly there does as well.
    for (double& number : rule.reference) number += 0.2;
    EXPECT_LT(greatest_spread(rotation, rule, off_rad), 0.05);
    EXPECT_LT(off_rad, 1e-7);  // and it is the same rotation
  }
}

}  // namespace
}  // namespace flatpose::job
