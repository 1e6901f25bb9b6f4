#include "bench/speed/thesis_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "flatpose/core/maths.hpp"
#include "flatpose/geometry/pose.hpp"

namespace flatpose::bench::thesis {
namespace {

constexpr int kSide = 12;
constexpr int kMargin = 8;
constexpr int kAngles = 10;

float uniform(std::mt19937& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}

Normal some_normal(std::mt19937& random) {
  const float x = uniform(random, -0.5F, 0.5F);
  const float y = uniform(random, -0.5F, 0.5F);
  return {x, y, std::sqrt(1.0F - x * x - y * y), 0.0F};
}

/// Random images, a cloud of 3 + 4 points and three tilts.
struct Made {
  Images images;
  Cloud cloud;
  std::vector<Tilt> tilts{3};

  explicit Made(unsigned seed) {
    std::mt19937 random(seed);
    images.width_px = images.height_px = kSide;
    images.margin_px = kMargin;
    const auto pixel_count = static_cast<std::size_t>(images.row_px() * images.row_px());
    for (std::size_t i = 0; i < pixel_count; ++i) {
      images.chamfer_px.push_back(uniform(random, 0.0F, 9.0F));
      images.normal.push_back(some_normal(random));
    }
    for (int i = 0; i < kSide * kSide; ++i)
      images.tilt.push_back(static_cast<std::uint16_t>(random() % tilts.size()));
    const auto coordinate = [&] { return uniform(random, -5.0F, 5.0F); };
    for (int i = 0; i < 3; ++i) cloud.edge.push_back({coordinate(), coordinate()});
    for (int i = 0; i < 4; ++i)
      cloud.surface.push_back({coordinate(), coordinate(), some_normal(random)});
    for (Tilt& tilt : tilts) {
      const Vec3 up = normalized({static_cast<double>(uniform(random, -0.4F, 0.4F)), 0.2, 1.0});
      tilt.cos_tilt = static_cast<float>(up.z);
      for (int k = 0; k < kAngles; ++k) {
        const Rotation r = tilt_rotation(up) * rotation_about_z(2.0 * kPi * k / kAngles);
        Turn& turn = tilt.turns.emplace_back();
        for (std::size_t i = 0; i < 9; ++i) turn.m[i] = static_cast<float>(r.m[i]);
      }
      make_tables(images, cloud, tilt);
    }
  }
};

/// Equations 2.2 and 2.8's errors, spelled out.
double slow_error(const Made& made, const Tilt& tilt, const Turn& turn, int column, int row) {
  // Halves of a pixel fall where 4096.5 in floats lets them.
  const auto rounded = [](float value) {
    return static_cast<int>(std::floor(value + 4096.5F)) - 4096;
  };
  const auto pixel = [&](float x, float y) {
    return made.images.index(column + rounded(turn.m[0] * x + turn.m[1] * y),
                             row + rounded(turn.m[3] * x + turn.m[4] * y));
  };
  double edge = 0.0;
  for (const EdgePoint& p : made.cloud.edge)
    edge += static_cast<double>(made.images.chamfer_px[pixel(p.x, p.y)]);
  double surface = 0.0;
  for (const SurfacePoint& p : made.cloud.surface) {
    const Normal& found = made.images.normal[pixel(p.x, p.y)];
    const float n[3] = {p.normal.x, p.normal.y, p.normal.z};
    const float f[3] = {found.x, found.y, found.z};
    for (int i = 0; i < 3; ++i) {
      const float* m = turn.m + 3 * i;
      const double off = static_cast<double>(f[i] - (m[0] * n[0] + m[1] * n[1] + m[2] * n[2]));
      surface += off * off;
    }
  }
  return edge / static_cast<double>(tilt.cos_tilt) + surface;
}

std::vector<double> all_errors(const Made& made) {
  std::vector<double> errors;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const std::uint16_t its_tilt =
          made.images.tilt[static_cast<std::size_t>(row * kSide + column)];
      if (its_tilt == kNoHypothesis) continue;
      for (const Turn& turn : made.tilts[its_tilt].turns)
        errors.push_back(slow_error(made, made.tilts[its_tilt], turn, column, row));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

void expect_best(const Made& made, Form form) {
  const std::vector<double> slow = all_errors(made);
  const std::vector<Hypothesis> best = search(made.images, made.cloud, made.tilts, form);
  ASSERT_EQ(best.size(), kKept);
  for (std::size_t i = 0; i < kKept; ++i) {
    const Hypothesis& h = best[i];
    EXPECT_NEAR(static_cast<double>(h.error), slow[i], 1e-4);
    const Tilt& tilt =
        made.tilts[made.images.tilt[static_cast<std::size_t>(h.row * kSide + h.column)]];
    EXPECT_NEAR(
        static_cast<double>(h.error),
        slow_error(made, tilt, tilt.turns[static_cast<std::size_t>(h.angle)], h.column, h.row),
        1e-4);
  }
}

TEST(ThesisSearch, FindsTheBestOfAllHypothesesInBothForms) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Made made(seed);
    expect_best(made, Form::kProjecting);
    expect_best(made, Form::kTabled);
  }
}

TEST(ThesisSearch, LeavesOutWhatIsNoHypothesis) {
  Made made(3);
  for (std::size_t i = 0; i < made.images.tilt.size(); ++i) {
    if (i % 3 != 0) made.images.tilt[i] = kNoHypothesis;
  }
  expect_best(made, Form::kProjecting);
  expect_best(made, Form::kTabled);
}

}  // namespace
}  // namespace flatpose::bench::thesis
