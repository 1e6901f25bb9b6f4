// What a match says of its own accuracy, against what the truth says of it.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "tests/lib/locate/small_parts.hpp"

namespace flatpose::locate {
namespace {

using test::SharedPart;

/// x, y, z along the face's axes, turns about the object's.
using Six = std::array<double, 6>;

struct Trial {
  Pose true_T_found;  ///< Seen from where the taught frame should lie.
  Rotation face_R_true;
  Match match;
};

Six sigmas_of(const Match& m) {
  return {m.sigma_mm.x, m.sigma_mm.y, m.sigma_mm.z, m.sigma_rad.x, m.sigma_rad.y, m.sigma_rad.z};
}

/// The turn about z that leads from one pose to another, as far as they lean alike.
double turn_between(const Rotation& from, const Rotation& to) {
  const Rotation r = from.inverse() * to;
  return arc_tangent(r.m[3] - r.m[1], r.m[0] + r.m[4]);
}

/// A part of full symmetry is turned about its axis as it was found.
Trial trial_of(const Match& match, const Pose& face_T_part, const Pose& part_T_object) {
  Pose face_T_true = face_T_part * part_T_object;
  if (match.turn_is_free) {
    const double turn_rad = turn_between(face_T_true.rotation, match.face_T_object.rotation);
    face_T_true = face_T_part * Pose{rotation_about_z(turn_rad), {}} * part_T_object;
  }
  return {face_T_true.inverse() * match.face_T_object, face_T_true.rotation, match};
}

/// Finds the part in scans of its own, each in another pose, all with the same covers.
std::vector<Trial> trials(const SharedPart& part, double noise_mm, int count,
                          const std::vector<sim::Instance>& covers = {}) {
  const sim::SensorConfig sensor = test::small_sensor(noise_mm);
  const test::Lesson lesson = test::lesson(part, sensor);
  test::Locating locating(test::small_field_limits());
  LocateConfig config;
  config.min_visible = 0.3;
  std::vector<Trial> all;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = 100 + static_cast<std::uint64_t>(i);
    const sim::SimulatedScan scan =
        test::shot(part, test::pose_by_lot(*part, seed), sensor, seed, covers);
    EXPECT_EQ(locating.run(lesson.part, scan.view(), config), Status::kOk);
    EXPECT_EQ(locating.result.match_count, 1) << seed;
    if (locating.result.match_count == 0) continue;
    all.push_back(trial_of(locating.result.matches[0], scan.instances.front().scan_T_object,
                           lesson.object_T_part.inverse()));
  }
  return all;
}

Six error_seen_from_true(const Trial& t) {
  const Vec3& p = t.true_T_found.position_mm;
  const Rotation& r = t.true_T_found.rotation;
  return {p.x, p.y, p.z, 0.5 * (r.m[7] - r.m[5]), 0.5 * (r.m[2] - r.m[6]), 0.5 * (r.m[3] - r.m[1])};
}

/// Mean over the trials of (error / sigma)^2. What was taught amiss stands in every scan alike and
/// is no part of sigma: the mean error, in the object's axes, is taken off.
Six normalised_squares(const std::vector<Trial>& all) {
  const double count = static_cast<double>(all.size());
  Six mean{};
  for (const Trial& t : all)
    for (int k = 0; k < 6; ++k) mean[k] += error_seen_from_true(t)[k] / count;
  Six squares{};
  for (const Trial& t : all) {
    Six e = error_seen_from_true(t);
    for (int k = 0; k < 6; ++k) e[k] -= mean[k];
    const Vec3 along_face = t.face_R_true * Vec3{e[0], e[1], e[2]};
    e[0] = along_face.x;
    e[1] = along_face.y;
    e[2] = along_face.z;
    const Six sigma = sigmas_of(t.match);
    for (int k = 0; k < 6; ++k) squares[k] += e[k] * e[k] / (sigma[k] * sigma[k]) / (count - 1.0);
  }
  return squares;
}

struct Case {
  std::string name;
  SharedPart part;
  double noise_mm;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Sigma : public testing::TestWithParam<Case> {};

// Expected is one, within what the mean of so many squares scatters by itself and what is known to
// be left out. z and the turns out of the plane: points counted twice where patches overlap, and
// mixed points at the rim. x, y and the turn in the plane: a contour point's variance holds its
// scatter in the teach scan and again in this one, and neighbours on one scan line are not
// independent; the first outweighs the second.
TEST_P(Sigma, ErrorsSquaredInItsUnitsAverageNearOne) {
  constexpr int kCount = 100;
  const std::vector<Trial> all = trials(GetParam().part, GetParam().noise_mm, kCount);
  ASSERT_EQ(all.size(), std::size_t{kCount});
  const Six squares = normalised_squares(all);
  const double scatter = 3.0 * std::sqrt(2.0 / kCount);
  const bool turn_is_free = GetParam().part->symmetry_fold == 0;
  for (const int k : {2, 3, 4}) {
    EXPECT_GT(squares[k], 0.9 * (1.0 - scatter)) << k;
    EXPECT_LT(squares[k], 1.2 * (1.0 + scatter)) << k;
  }
  for (const int k : {0, 1, 5}) {
    if (k == 5 && turn_is_free) continue;
    EXPECT_GT(squares[k], 0.5 * (1.0 - scatter)) << k;
    EXPECT_LT(squares[k], 1.0 * (1.0 + scatter)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Made, Sigma,
                         testing::Values(Case{"ell_quiet", test::small_ell(), 0.05},
                                         Case{"ell_noisy", test::small_ell(), 0.5},
                                         Case{"disc_quiet", test::small_disc(), 0.05},
                                         Case{"disc_noisy", test::small_disc(), 0.5}),
                         [](const auto& made) { return made.param.name; });

Six mean_sigmas(const std::vector<Trial>& all) {
  Six mean{};
  for (const Trial& t : all)
    for (int k = 0; k < 6; ++k) mean[k] += sigmas_of(t.match)[k] / static_cast<double>(all.size());
  return mean;
}

TEST(SigmaOfAMatch, GrowsWithTheNoise) {
  const Six quiet = mean_sigmas(trials(test::small_ell(), 0.05, 10));
  const Six usual = mean_sigmas(trials(test::small_ell(), 0.2, 10));
  const Six noisy = mean_sigmas(trials(test::small_ell(), 0.5, 10));
  // What the surface tells is as noisy as its points; the contour's place is rather a matter of
  // where the points lie.
  for (const int k : {2, 3, 4}) {
    EXPECT_GT(usual[k], 1.5 * quiet[k]) << k;
    EXPECT_GT(noisy[k], 1.5 * usual[k]) << k;
  }
  for (const int k : {0, 1, 5}) EXPECT_GT(noisy[k], quiet[k]) << k;
}

TEST(SigmaOfAMatch, GrowsWithWhatIsCovered) {
  const auto board = test::made({.name = "board", .outline = {}, .thickness_mm = 2.0, .areas = {}},
                                sim::rectangle({}, 60.0, 90.0));
  const auto reaching = [&](double x_mm) {
    return std::vector<sim::Instance>{{board, {Rotation{}, {x_mm + 30.0, 0.0, 25.0}}}};
  };
  const Six open = mean_sigmas(trials(test::small_ell(), 0.2, 10));
  const Six less = mean_sigmas(trials(test::small_ell(), 0.2, 10, reaching(10.0)));
  const Six least = mean_sigmas(trials(test::small_ell(), 0.2, 10, reaching(0.0)));
  for (int k = 0; k < 6; ++k) {
    EXPECT_GT(less[k], 1.05 * open[k]) << k;
    EXPECT_GT(least[k], 1.05 * less[k]) << k;
  }
}

}  // namespace
}  // namespace flatpose::locate
