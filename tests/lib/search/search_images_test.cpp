#include "flatpose/search/search_images.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/lib/image/image.hpp"
#include "tests/lib/search/made_images.hpp"

namespace flatpose::search {
namespace {

constexpr double kAnyJump_mm = 1e6;

/// A scene made by hand: heights and edges, no rectification behind it.
struct MadeScene {
  image::Image<float> height;
  std::vector<image::EdgePoint> edges;
  scene::Scene scene;
  Memory memory{1 << 23};
  SearchImages images;

  explicit MadeScene(const image::Image<float>& heights, double cell_mm = 0.5) : height(heights) {
    scene.map.grid = {-7.0, 3.0, cell_mm, height.width(), height.height()};
    scene.map.height_mm = height.view();
    images = take_search_images(memory.arena, scene.map.grid);
  }
  void add_edge(int column, int row, double angle_rad,
                image::EdgeKind kind = image::EdgeKind::kJump) {
    edges.push_back({static_cast<float>(column), static_cast<float>(row),
                     static_cast<float>(std::cos(angle_rad)),
                     static_cast<float>(std::sin(angle_rad)), 3.0F,
                     static_cast<std::int16_t>(column), static_cast<std::int16_t>(row), kind});
  }
  Status build(double jump_mm = kAnyJump_mm) {
    scene.edges = edges;
    const std::size_t used_bytes = memory.arena.used_bytes();
    const Status status = build_search_images(scene, jump_mm, memory.arena, images);
    EXPECT_EQ(memory.arena.used_bytes(), used_bytes) << "the scratch is given back";
    return status;
  }
};

/// The 3-4 path length between two cells of an empty map.
int chamfer(int dx, int dy) {
  const int ax = std::abs(dx);
  const int ay = std::abs(dy);
  return 3 * std::max(ax, ay) + std::min(ax, ay);
}

TEST(SearchImages, HaveHalfTheResolutionOverTheSameField) {
  MadeScene made(image::Image<float>(21, 14));
  ASSERT_EQ(made.build(), Status::kOk);
  EXPECT_EQ(made.images.grid.width_px, 11);
  EXPECT_EQ(made.images.grid.height_px, 7);
  EXPECT_EQ(made.images.grid.cell_mm, 1.0);
  EXPECT_EQ(made.images.grid.x_of(0), -7.0 + 0.25) << "the middle of two fine cells";
  for (const auto& channel : made.images.edge_cost) {
    EXPECT_TRUE(same_shape(channel, made.images.missing));
  }
  EXPECT_TRUE(same_shape(made.images.height_unit, made.images.missing));
}

TEST(SearchImages, HeightsAreRoundedToTheNearestUnit) {
  MadeScene made(image::random_image(40, 30, 3));
  ASSERT_EQ(made.build(), Status::kOk);
  for (int y = 0; y < 15; ++y) {
    for (int x = 0; x < 20; ++x) {
      const double above_mm = made.images.filled_mm(x, y) - made.images.base_mm;
      EXPECT_NEAR(made.images.height_unit(x, y), above_mm * kHeightUnitsPerMm, 0.5 + 1e-9);
    }
  }
}

TEST(SearchImages, HeightsBeyondTheirRangeSaturateOnTheirOwnSide) {
  MadeScene made(
      image::Image<float>::of(8, 8, [](int x, int) { return x < 4 ? -9000.0F : 9000.0F; }));
  ASSERT_EQ(made.build(), Status::kOk);
  EXPECT_EQ(made.images.height_unit(0, 0), -32767);
  EXPECT_EQ(made.images.height_unit(3, 3), 32767);
}

TEST(SearchImages, NormalsArePlanesNormals) {
  for (const auto& [sx, sy] : {std::pair{0.0, 0.0}, {0.5, -0.25}, {-3.0, 2.0}, {40.0, -60.0}}) {
    MadeScene made(image::Image<float>::of(
        16, 12, [&, a = sx, b = sy](int x, int y) { return 0.5 * (a * x + b * y); }));
    ASSERT_EQ(made.build(), Status::kOk);
    const Vec3 normal = normalized({-sx, -sy, 1.0});
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        EXPECT_NEAR(made.images.normal_x_unit(x, y), normal.x * kNormalUnits, 0.51);
        EXPECT_NEAR(made.images.normal_y_unit(x, y), normal.y * kNormalUnits, 0.51);
      }
    }
  }
}

TEST(SearchImages, MissingIsWhatHasNoneOfItsFourCells) {
  std::mt19937 random(4);
  MadeScene made(image::Image<float>::of(30, 22, [&](int, int) {
    return random() % 3 != 0 ? std::numeric_limits<float>::quiet_NaN()
                             : static_cast<float>(random() % 9);
  }));
  ASSERT_EQ(made.build(), Status::kOk);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 15; ++x) {
      bool seen = false;
      for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        seen = seen || !std::isnan(made.height(2 * x + i, 2 * y + j));
      }
      EXPECT_EQ(made.images.missing(x, y), seen ? 0 : 1);
      EXPECT_TRUE(std::isfinite(made.images.filled_mm(x, y))) << "filled all the same";
    }
  }
}

TEST(SearchImages, NothingIsAveragedAcrossAJump) {
  MadeScene made(image::Image<float>::of(8, 8, [](int x, int) { return x < 3 ? 10.0F : 2.0F; }));
  ASSERT_EQ(made.build(1.0), Status::kOk);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) EXPECT_EQ(made.images.filled_mm(x, y), x < 2 ? 10.0F : 2.0F);
  }
}

TEST(SearchImages, AnEdgeIsCountedByItsOwnDirectionAndNotByTheOpposite) {
  for (int eighth = 0; eighth < 8; ++eighth) {
    MadeScene made(image::Image<float>(40, 36));
    made.add_edge(17, 20, eighth * kPi / 4.0);
    ASSERT_EQ(made.build(), Status::kOk);
    for (int octant = 0; octant < 8; ++octant) {
      const int apart = std::min((octant - eighth + 8) % 8, (eighth - octant + 8) % 8);
      for (int y = 0; y < 18; ++y) {
        for (int x = 0; x < 20; ++x) {
          const int found = made.images.edge_cost[octant](x, y);
          const int nearest = std::min<int>(kEdgeCostMax, chamfer(x - 8, y - 10));
          if (apart == 0) {
            ASSERT_EQ(found, nearest);
          } else if (apart >= 2) {
            ASSERT_EQ(found, kEdgeCostMax);
          }
        }
      }
    }
  }
}

TEST(SearchImages, EdgeCostIsTheDistanceToTheNearestOfTheEdgesOfItsChannel) {
  std::mt19937 random(5);
  MadeScene made(image::Image<float>(50, 44));
  for (int i = 0; i < 25; ++i) {  // on an octant's axis: in that channel alone
    made.add_edge(integer(random, 0, 49), integer(random, 0, 43),
                  integer(random, 0, 7) * kPi / 4.0);
  }
  ASSERT_EQ(made.build(), Status::kOk);
  for (int octant = 0; octant < 8; ++octant) {
    for (int y = 0; y < 22; ++y) {
      for (int x = 0; x < 25; ++x) {
        int nearest = kEdgeCostMax;
        for (const image::EdgePoint& edge : made.edges) {
          if (image::octant_of(edge.dx, edge.dy) == octant)
            nearest = std::min(nearest, chamfer(edge.column / 2 - x, edge.row / 2 - y));
        }
        ASSERT_EQ(made.images.edge_cost[octant](x, y), nearest);
      }
    }
  }
}

TEST(SearchImages, CreasesAreNoContours) {
  MadeScene made(image::Image<float>(20, 20));
  made.add_edge(10, 10, 0.0, image::EdgeKind::kCrease);
  ASSERT_EQ(made.build(), Status::kOk);
  for (const auto& channel : made.images.edge_cost) EXPECT_EQ(channel(5, 5), kEdgeCostMax);
}

TEST(SearchImages, OfASceneWithNothingInItFail) {
  MadeScene made(image::Image<float>(20, 20, std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(made.build(), Status::kTooFewPoints);
}

TEST(SearchImages, OfTheSmallestMapsAreSound) {
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 1}, {1, 3}, {3, 3}, {2, 40}}) {
    MadeScene made(image::random_image(w, h, 8));
    made.add_edge(w - 1, h - 1, 0.3);
    ASSERT_EQ(made.build(), Status::kOk) << w << 'x' << h;
    EXPECT_EQ(made.images.missing(0, 0), 0);
  }
}

TEST(SearchImages, FitIntoTheScratchThatIsReservedAndFailInLess) {
  MadeScene made(image::random_image(60, 50, 9));
  for (int i = 0; i < 60 * 50 / 4; ++i) made.add_edge(i % 60, i / 60, 0.1 * i);
  made.scene.edges = made.edges;
  Arena measuring = Arena::measuring();
  reserve_search_scratch(measuring, made.scene.map.grid);
  Memory enough(measuring.required_bytes());
  EXPECT_EQ(build_search_images(made.scene, 1.0, enough.arena, made.images), Status::kOk);
  for (const std::size_t size_bytes : {0U, 64U, 200U, 1000U, 5000U}) {
    Memory little(size_bytes);
    EXPECT_EQ(build_search_images(made.scene, 1.0, little.arena, made.images), Status::kOutOfMemory)
        << size_bytes;
  }
}

}  // namespace
}  // namespace flatpose::search
