// The cost against a slow one, written from the words of score.hpp alone: in floating point where
// the product counts in integers, all points, no early end.

#include "flatpose/search/score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/lib/search/made_images.hpp"

namespace flatpose::search {
namespace {

constexpr std::int32_t kNoLimit = 1 << 30;

struct Cell {
  int x, y;
  bool inside;
};

class SlowScore {
 public:
  SlowScore(const SearchImages& images, const ScoreScale& scale, const Place& place)
      : images_(images), scale_(scale), place_(place) {}

  [[nodiscard]] std::int32_t cost(const ProjectedTemplate& t) const {
    double edges = 0.0;
    double rest = 0.0;
    for (int i = 0; i < t.contour_count; ++i) edges += edge(t.contour[i]);
    for (int i = 0; i < t.surface_count; ++i) rest += surface(t.surface[i]);
    return static_cast<std::int32_t>(std::floor(edges * t.edge_factor_q8 / 256.0) + rest);
  }

 private:
  static constexpr double kHalfEdge = 8.0;  // of 15, of 15 and of 7
  static constexpr double kHalfHeight = 8.0;
  static constexpr double kHalfNormal = 4.0;

  [[nodiscard]] Cell cell(int dx, int dy) const {
    const int x = place_.column + dx;
    const int y = place_.row + dy;
    return {x, y, x >= 0 && x < images_.grid.width_px && y >= 0 && y < images_.grid.height_px};
  }
  [[nodiscard]] double edge(const ProjectedTemplate::Contour& p) const {
    const Cell at = cell(p.dx, p.dy);
    if (!at.inside) return kHalfEdge;
    double lowest = kEdgeCostMax;
    for (int octant = 0; octant < image::kOctantCount; ++octant) {
      if (scale_.use_directions && octant != p.octant) continue;
      lowest = std::min(lowest, 1.0 * images_.edge_cost[octant](at.x, at.y));
    }
    return lowest;
  }
  [[nodiscard]] double surface(const ProjectedTemplate::Surface& p) const {
    const Cell at = cell(p.dx, p.dy);
    const double unknown = kHalfNormal + (scale_.use_height ? kHalfHeight : 0.0);
    if (!at.inside || images_.missing(at.x, at.y) != 0) return unknown;
    double sum = 0.0;
    if (scale_.use_height) {
      const double lift =
          std::floor((1.0 * place_.slope_x_q8 * p.dx + 1.0 * place_.slope_y_q8 * p.dy) / 256.0);
      const double above =
          images_.height_unit(at.x, at.y) - (place_.height_unit + p.height_unit + lift);
      const double steps = std::floor(std::fabs(above) * scale_.height_factor_q8 / 256.0);
      if (above > 0.0 && steps >= kHeightCostMax) return unknown;
      sum += std::min(steps, 1.0 * kHeightCostMax);
    }
    const double tilt = std::max(
        std::fabs(1.0 * images_.normal_x_unit(at.x, at.y) - place_.normal_x_unit - p.normal_x_unit),
        std::fabs(1.0 * images_.normal_y_unit(at.x, at.y) - place_.normal_y_unit -
                  p.normal_y_unit));
    return sum + std::min(std::floor(tilt * scale_.normal_factor_q8 / 256.0), 1.0 * kNormalCostMax);
  }

  const SearchImages& images_;
  const ScoreScale& scale_;
  const Place& place_;
};

ScoreConfig random_config(std::mt19937& random) {
  ScoreConfig config;
  config.contour_count = integer(random, 0, kSparsePointCountMax);
  config.surface_count = integer(random, 0, kSparsePointCountMax);
  config.height_tolerance_mm = uniform(random, 0.2, 6.0);
  config.normal_tolerance_rad = uniform(random, 0.05, 0.8);
  config.use_height = random() % 4 != 0;
  config.use_directions = random() % 4 != 0;
  return config;
}

ProjectedTemplate random_projection(std::mt19937& random, const ScoreConfig& config) {
  const auto part = random_part(random, 9.0, integer(random, 1, 40), integer(random, 3, 40));
  return project(*part, part->anchors[0], uniform(random, -1.5, 1.5), uniform(random, -1.5, 1.5),
                 uniform(random, -kPi, kPi), 1.0, config);
}

Place random_place(std::mt19937& random, const SearchImages& images) {
  Place place;
  place.column = static_cast<std::int16_t>(integer(random, 0, images.grid.width_px - 1));
  place.row = static_cast<std::int16_t>(integer(random, 0, images.grid.height_px - 1));
  place.height_unit = integer(random, -60, 60);
  place.slope_x_q8 = integer(random, -4000, 4000);
  place.slope_y_q8 = integer(random, -4000, 4000);
  place.normal_x_unit = static_cast<std::int16_t>(integer(random, -100, 100));
  place.normal_y_unit = static_cast<std::int16_t>(integer(random, -100, 100));
  return place;
}

template <class Check>
void over_random_hypotheses(unsigned seed, const Check& check) {
  std::mt19937 random(seed);
  const MadeImages made(17, 13);
  for (int scene = 0; scene < 20; ++scene) {
    made.randomise(random, 100);
    for (int trial = 0; trial < 200; ++trial) {
      const ScoreConfig config = random_config(random);
      const ProjectedTemplate projected = random_projection(random, config);
      check(random, made.images, projected, score_scale(config), random_place(random, made.images));
    }
  }
}

TEST(Score, EqualsTheSlowOneEverywhere) {
  over_random_hypotheses(
      1, [](std::mt19937&, const SearchImages& images, const ProjectedTemplate& projected,
            const ScoreScale& scale, const Place& place) {
        ASSERT_EQ(cost(images, projected, scale, place, kNoLimit),
                  SlowScore(images, scale, place).cost(projected));
      });
}

TEST(Score, EndsEarlyOnlyWhereTheLimitIsReached) {
  int below = 0;
  over_random_hypotheses(
      2, [&](std::mt19937& random, const SearchImages& images, const ProjectedTemplate& projected,
             const ScoreScale& scale, const Place& place) {
        const std::int32_t exact = cost(images, projected, scale, place, kNoLimit);
        for (const std::int32_t limit :
             {0, exact - 1, exact, exact + 1, integer(random, 0, 2 * exact + 2)}) {
          const std::int32_t found = cost(images, projected, scale, place, limit);
          ASSERT_EQ(found < limit, exact < limit) << "limit " << limit << " exact " << exact;
          if (exact < limit) {
            ASSERT_EQ(found, exact);
            ++below;
          }
        }
      });
  EXPECT_GT(below, 1000);
}

TEST(Score, IsNeverNegativeNorOverItsMaximum) {
  over_random_hypotheses(
      3, [](std::mt19937&, const SearchImages& images, const ProjectedTemplate& projected,
            const ScoreScale& scale, const Place& place) {
        const std::int32_t found = cost(images, projected, scale, place, kNoLimit);
        ASSERT_GE(found, 0);
        ASSERT_LE(found, cost_max(projected, scale));
      });
}

TEST(Score, ReachesItsMaximumWhereEverythingContradicts) {
  std::mt19937 random(4);
  const MadeImages made(40, 40);
  made.for_each([&](int x, int y) {
    made.images.height_unit(x, y) = -30000;  // far below: not hidden, contradicted
    made.images.normal_x_unit(x, y) = 127;
  });
  Place place;
  place.column = place.row = 20;
  place.normal_x_unit = -100;
  for (int trial = 0; trial < 100; ++trial) {
    const ScoreConfig config = random_config(random);
    const ProjectedTemplate projected = random_projection(random, config);
    const ScoreScale scale = score_scale(config);
    EXPECT_EQ(cost(made.images, projected, scale, place, kNoLimit), cost_max(projected, scale));
  }
}

TEST(Score, IsZeroWhereEverythingFits) {
  const MadeImages made(40, 40);
  for (const auto& channel : made.images.edge_cost) {
    made.for_each([&](int x, int y) { channel(x, y) = 0; });
  }
  const auto part = plate(20.0, 12.0);
  const ProjectedTemplate projected = project(*part, part->anchors[0], 0, 0, 0.7, 1.0, {});
  Place place;
  place.column = place.row = 20;
  EXPECT_EQ(cost(made.images, projected, score_scale({}), place, kNoLimit), 0);
}

// One point alone, so that its cost is the sum.
struct OnePoint {
  MadeImages made{9, 9};
  ProjectedTemplate projected;
  ScoreConfig config;
  Place place;

  OnePoint() { place.column = place.row = 4; }
  [[nodiscard]] std::int32_t cost_of_it() const {
    return cost(made.images, projected, score_scale(config), place, kNoLimit);
  }
};

TEST(Score, OfAContourPointOutsideTheFieldIsHalf) {
  OnePoint one;
  one.projected.contour_count = 1;
  EXPECT_EQ(one.cost_of_it(), kEdgeCostMax);
  for (const auto& [dx, dy] : {std::pair{-5, 0}, {5, 0}, {0, -5}, {0, 5}, {-32768, 32767}}) {
    one.projected.contour[0].dx = static_cast<std::int16_t>(dx);
    one.projected.contour[0].dy = static_cast<std::int16_t>(dy);
    EXPECT_EQ(one.cost_of_it(), (kEdgeCostMax + 1) / 2) << dx << ' ' << dy;
  }
}

TEST(Score, OfASurfacePointOutsideOrMissingOrHiddenIsHalf) {
  constexpr std::int32_t kHalf = (kNormalCostMax + 1) / 2 + (kHeightCostMax + 1) / 2;
  OnePoint one;
  one.projected.surface_count = 1;
  EXPECT_EQ(one.cost_of_it(), 0);
  one.projected.surface[0].dx = 5;
  EXPECT_EQ(one.cost_of_it(), kHalf) << "outside";
  one.projected.surface[0].dx = 4;
  EXPECT_EQ(one.cost_of_it(), 0) << "the last column is inside";
  one.made.images.missing(8, 4) = 1;
  EXPECT_EQ(one.cost_of_it(), kHalf) << "missing";
  one.made.images.missing(8, 4) = 0;
  one.made.images.height_unit(8, 4) = 2000;
  EXPECT_EQ(one.cost_of_it(), kHalf) << "hidden";
  one.made.images.height_unit(8, 4) = -2000;
  EXPECT_EQ(one.cost_of_it(), kHeightCostMax) << "what lies lower contradicts in full";
  one.config.use_height = false;
  EXPECT_EQ(one.cost_of_it(), 0) << "heights are not looked at";
  one.projected.surface[0].dx = 5;
  EXPECT_EQ(one.cost_of_it(), (kNormalCostMax + 1) / 2);
}

TEST(Score, GrowsWithTheHeightUpToTheToleranceAndNoFurther) {
  OnePoint one;
  one.projected.surface_count = 1;
  const int tolerance_unit = static_cast<int>(one.config.height_tolerance_mm * kHeightUnitsPerMm);
  std::int32_t previous = 0;
  for (int below = 0; below < 3 * tolerance_unit; ++below) {
    one.made.images.height_unit(4, 4) = static_cast<std::int16_t>(-below);
    const std::int32_t now = one.cost_of_it();
    EXPECT_GE(now, previous);
    EXPECT_NEAR(now, std::min(1.0, 1.0 * below / tolerance_unit) * kHeightCostMax, 1.001);
    previous = now;
  }
  EXPECT_EQ(previous, kHeightCostMax);
}

TEST(Score, CountsAnEdgeOfItsDirectionOnlyUnlessToldOtherwise) {
  OnePoint one;
  one.projected.contour_count = 1;
  for (int octant = 0; octant < image::kOctantCount; ++octant) {
    one.projected.contour[0].octant = static_cast<std::int16_t>(octant);
    for (int other = 0; other < image::kOctantCount; ++other) {
      one.made.images.edge_cost[other](4, 4) = 2;
      one.config.use_directions = true;
      EXPECT_EQ(one.cost_of_it(), other == octant ? 2 : kEdgeCostMax);
      one.config.use_directions = false;
      EXPECT_EQ(one.cost_of_it(), 2);
      one.made.images.edge_cost[other](4, 4) = kEdgeCostMax;
    }
  }
}

}  // namespace
}  // namespace flatpose::search
