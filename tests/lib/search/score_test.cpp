// The cost against a slow one, written from the words of score.hpp alone: in floating point where
// the product counts in integers, cell by cell from images that were never spread.

#include "flatpose/search/score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/lib/search/made_images.hpp"
#include "tests/lib/search/made_projection.hpp"

namespace flatpose::search {
namespace {

class SlowScore {
 public:
  SlowScore(const MadeImages& made, int column, int row, int place_unit)
      : made_(made), column_(column), row_(row), place_unit_(place_unit) {}

  [[nodiscard]] double cost(const ProjectedTemplate& t) const {
    double edges = 0.0;
    double rest = 0.0;
    for (int i = 0; i < t.contour_count; ++i) edges += edge(t.contour[i]);
    for (int i = 0; i < t.surface_count; ++i)
      rest += made_.images.config.use_height ? height(t.surface[i]) : normal(t.surface[i]);
    return std::min(
        255.0, rest * made_.images.surface_weight + std::floor(edges * t.edge_factor_q8 / 256.0));
  }

 private:
  struct Cell {
    int x, y;
    bool is_inside;
  };
  template <class Point>
  [[nodiscard]] Cell cell(const Point& p) const {
    const int x = column_ + p.dx;
    const int y = row_ + p.dy;
    return {x, y, x >= 0 && x < made_.width() && y >= 0 && y < made_.height_px()};
  }
  [[nodiscard]] double cap() const { return made_.images.surface_cap; }
  /// How much higher the cell is than the point should be; infinite outside the field.
  [[nodiscard]] double above(const Cell& at, double rise_unit) const {
    if (!at.is_inside) return std::numeric_limits<double>::infinity();
    return made_.height(at.x, at.y) - std::clamp(place_unit_ + rise_unit, 0.0, 240.0);
  }
  [[nodiscard]] double edge(const ProjectedTemplate::Contour& p) const {
    const Cell at = cell(p);
    if (!at.is_inside) return 8.0;
    double lowest = 15.0;
    for (int octant = 0; octant < image::kOctantCount; ++octant) {
      if (made_.images.config.use_directions && octant != p.octant) continue;
      lowest = std::min<double>(lowest, made_.edge[static_cast<std::size_t>(octant)](at.x, at.y));
    }
    const bool is_hidden = made_.images.config.use_height && above(at, p.rise_unit) > cap();
    return is_hidden ? std::min(8.0, lowest) : lowest;
  }
  [[nodiscard]] double height(const ProjectedTemplate::Surface& p) const {
    const double off = above(cell(p), p.rise_unit);
    return off > cap() ? std::floor(cap() / 2.0) : std::min(std::fabs(off), cap());
  }
  [[nodiscard]] double normal(const ProjectedTemplate::Surface& p) const {
    const Cell at = cell(p);
    if (!at.is_inside) return std::floor(cap() / 2.0);
    const double off = std::max(std::fabs(1.0 * made_.normal_x(at.x, at.y) - p.normal_x_unit),
                                std::fabs(1.0 * made_.normal_y(at.x, at.y) - p.normal_y_unit));
    return std::min(off, cap());
  }

  const MadeImages& made_;
  int column_, row_, place_unit_;
};

template <class Check>
void over_random_hypotheses(unsigned seed, const Check& check) {
  std::mt19937 random(seed);
  for (int scene = 0; scene < 64; ++scene) {
    SearchImagesConfig config;
    config.stride_px = 1 + scene % kStrideMax_px;
    config.reach_px = 1 << (random() % 6);
    config.use_height = scene / 4 % 2 == 0;
    config.use_directions = scene / 8 % 2 == 0;
    MadeImages made(integer(random, 1, 20), integer(random, 1, 20), config);
    if (config.use_height) {
      made.images.surface_cap = integer(random, 2, kSurfaceCostMax);
      made.images.surface_weight = kSurfaceCostMax / made.images.surface_cap;
    }
    made.randomise(random);
    for (int trial = 0; trial < 100; ++trial) {
      const ProjectedTemplate projected = random_projection(random, made.images);
      check(made, projected, integer(random, 0, made.width() - 1),
            integer(random, 0, made.height_px() - 1), integer(random, 0, kHeightUnitMax));
    }
  }
}

TEST(Score, EqualsTheSlowOneEverywhere) {
  int saturated = 0;
  over_random_hypotheses(1, [&](const MadeImages& made, const ProjectedTemplate& projected,
                                int column, int row, int place_unit) {
    const double slow = SlowScore(made, column, row, place_unit).cost(projected);
    ASSERT_EQ(cost(made.images, projected, column, row, place_unit), slow);
    saturated += slow == 255.0 ? 1 : 0;
  });
  EXPECT_GT(saturated, 10) << "both below and at the limit";
}

TEST(Score, IsNeverNegativeNorOverItsMaximum) {
  over_random_hypotheses(2, [](const MadeImages& made, const ProjectedTemplate& projected,
                               int column, int row, int place_unit) {
    const std::int32_t found = cost(made.images, projected, column, row, place_unit);
    ASSERT_GE(found, 0);
    ASSERT_LE(found, std::min(kCostMax, cost_max(made.images, projected)));
  });
}

TEST(Score, ReachesItsMaximumWhereEverythingContradicts) {
  std::mt19937 random(3);
  for (const bool use_height : {true, false}) {
    SearchImagesConfig config;
    config.reach_px = 9;
    config.use_height = use_height;
    MadeImages made(40, 40, config);
    made.for_each([&](int x, int y) {
      made.height(x, y) = 0;  // far below: not hidden, contradicted
      made.normal_x(x, y) = 0;
    });
    made.spread_all();
    for (int trial = 0; trial < 100; ++trial) {
      ProjectedTemplate projected = random_projection(random, made.images);
      for (auto& p : projected.surface) p.rise_unit = 0, p.normal_x_unit = 200;
      EXPECT_EQ(cost(made.images, projected, 20, 20, 240),
                std::min(kCostMax, cost_max(made.images, projected)));
    }
  }
}

/// One point alone, so that its cost is the sum.
struct OnePoint {
  MadeImages made;
  ProjectedTemplate projected;

  explicit OnePoint(const SearchImagesConfig& config = {1, 20}) : made(9, 9, config) {}
  std::int32_t cost_of_it() {
    made.spread_all();
    return cost(made.images, projected, 4, 4, 100);
  }
};

TEST(Score, OfAPointOutsideTheFieldIsHalf) {
  for (const bool use_height : {true, false}) {
    OnePoint edge({1, 20, 3.0, 0.35, use_height});
    edge.projected.contour_count = 1;
    OnePoint surface({1, 20, 3.0, 0.35, use_height});
    surface.projected.surface_count = 1;
    EXPECT_EQ(edge.cost_of_it(), kEdgeCostMax);
    EXPECT_EQ(surface.cost_of_it(), use_height ? 0 : kSurfaceCostMax) << "its normal leans";
    for (const auto& [dx, dy] : {std::pair{-5, 0}, {5, 0}, {0, -5}, {0, 5}, {-20, 20}, {20, -20}}) {
      edge.projected.contour[0].dx = surface.projected.surface[0].dx =
          static_cast<std::int16_t>(dx);
      edge.projected.contour[0].dy = surface.projected.surface[0].dy =
          static_cast<std::int16_t>(dy);
      EXPECT_EQ(edge.cost_of_it(), (kEdgeCostMax + 1) / 2) << dx << ' ' << dy;
      EXPECT_EQ(surface.cost_of_it(), kSurfaceCostMax / 2) << dx << ' ' << dy;
    }
  }
}

TEST(Score, OfWhatIsHiddenIsAtMostHalfAndOfWhatLiesLowerInFull) {
  OnePoint surface;
  surface.projected.surface_count = 1;
  OnePoint contour;
  contour.projected.contour_count = 1;
  for (int height = 0; height <= kHeightUnitMax; ++height) {
    surface.made.height(4, 4) = contour.made.height(4, 4) = static_cast<std::uint8_t>(height);
    const int above = height - 100;
    EXPECT_EQ(surface.cost_of_it(), above > 10 ? 5 : std::min(10, std::abs(above))) << above;
    for (const int distance : {0, 7, 8, 9, 15}) {
      contour.made.edge[0](4, 4) = static_cast<std::uint8_t>(distance);
      EXPECT_EQ(contour.cost_of_it(), above > 10 ? std::min(8, distance) : distance) << above;
    }
  }
}

TEST(Score, LooksAtNoHeightWhenItUsesNormals) {
  OnePoint one({1, 20, 3.0, 0.35, false});
  one.projected.contour_count = 1;
  one.projected.surface_count = 1;
  one.projected.surface[0].normal_x_unit = one.projected.surface[0].normal_y_unit = kNormalZero;
  for (const int height : {0, 100, 240}) {
    one.made.height(4, 4) = static_cast<std::uint8_t>(height);
    EXPECT_EQ(one.cost_of_it(), kEdgeCostMax);
  }
  for (int off = -127; off <= 127; ++off) {
    one.made.normal_x(4, 4) = static_cast<std::uint8_t>(kNormalZero + off);
    EXPECT_EQ(one.cost_of_it(), kEdgeCostMax + std::min(kSurfaceCostMax, std::abs(off)));
    one.made.normal_x(4, 4) = kNormalZero;
    one.made.normal_y(4, 4) = static_cast<std::uint8_t>(kNormalZero + off);
    EXPECT_EQ(one.cost_of_it(), kEdgeCostMax + std::min(kSurfaceCostMax, std::abs(off)));
    one.made.normal_y(4, 4) = kNormalZero;
  }
}

TEST(Score, ExpectsHeightsWithinWhatTheImagesHold) {
  EXPECT_EQ(expected_unit(100, 20), 120);
  EXPECT_EQ(expected_unit(100, -101), 0);
  EXPECT_EQ(expected_unit(100, 141), kHeightUnitMax);
  EXPECT_EQ(expected_unit(0, -32767), 0);
  EXPECT_EQ(expected_unit(240, 32767), kHeightUnitMax);
}

TEST(Score, CountsAnEdgeOfItsDirectionOnlyUnlessToldOtherwise) {
  for (const bool use_directions : {true, false}) {
    OnePoint one({1, 20, 3.0, 0.35, true, use_directions});
    one.projected.contour_count = 1;
    for (int octant = 0; octant < image::kOctantCount; ++octant) {
      one.projected.contour[0].octant = static_cast<std::int16_t>(octant);
      for (int other = 0; other < image::kOctantCount; ++other) {
        std::uint8_t& cell = one.made.edge[static_cast<std::size_t>(other)](4, 4);
        cell = 2;
        EXPECT_EQ(one.cost_of_it(), !use_directions || other == octant ? 2 : kEdgeCostMax);
        cell = kEdgeCostMax;
      }
    }
  }
}

}  // namespace
}  // namespace flatpose::search
