#include "flatpose/search/search_images.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "flatpose/core/maths.hpp"
#include "flatpose/search/grid_search.hpp"
#include "tests/lib/search/made_scene_images.hpp"

namespace flatpose::search {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The 3-4 path length between two cells of an empty map.
int chamfer(int dx, int dy) {
  const int ax = std::abs(dx);
  const int ay = std::abs(dy);
  return 3 * std::max(ax, ay) + std::min(ax, ay);
}

TEST(SearchImages, HaveHalfTheResolutionOverTheSameField) {
  const MadeScene made(image::Image<float>(21, 14));
  EXPECT_EQ(made.width(), 11);
  EXPECT_EQ(made.height_px(), 7);
  EXPECT_EQ(made.images.grid.cell_mm, 1.0);
  EXPECT_EQ(made.images.grid.x_of(0), -7.0 + 0.25) << "the middle of two fine cells";
}

TEST(SearchImages, FillWhatHasNoneOfItsFourCells) {
  std::mt19937 random(4);
  MadeScene made(image::Image<float>::of(30, 22, [&](int, int) {
    return random() % 3 != 0 ? kNan : static_cast<float>(random() % 9);
  }));
  ASSERT_EQ(made.build(), Status::kOk);
  int filled = 0;
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 15; ++x) {
      bool seen = false;
      for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        seen = seen || !std::isnan(made.height(2 * x + i, 2 * y + j));
      }
      filled += seen ? 0 : 1;
      EXPECT_TRUE(std::isfinite(made.images.filled_mm(x, y)));
    }
  }
  EXPECT_GT(filled, 10);
}

TEST(SearchImages, NothingIsAveragedAcrossAJump) {
  MadeScene made(image::Image<float>::of(8, 8, [](int x, int) { return x < 3 ? 10.0F : 2.0F; }));
  ASSERT_EQ(made.build({}, {0.0, 12.0}, 1.0), Status::kOk);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) EXPECT_EQ(made.images.filled_mm(x, y), x < 2 ? 10.0F : 2.0F);
  }
}

TEST(SearchImages, AnEdgeIsCountedByItsOwnDirectionAndNotByTheOpposite) {
  for (int eighth = 0; eighth < 8; ++eighth) {
    MadeScene made(image::Image<float>(40, 36));
    made.add_edge(17, 20, eighth * kPi / 4.0);
    ASSERT_EQ(made.build({.stride_px = 1 + eighth % kStrideMax_px}), Status::kOk);
    for (int octant = 0; octant < 8; ++octant) {
      const int apart = std::min((octant - eighth + 8) % 8, (eighth - octant + 8) % 8);
      for (int y = 0; y < 18; ++y) {
        for (int x = 0; x < 20; ++x) {
          const int found = made.images.edge_cost(octant, x, y);
          if (apart == 0) {
            ASSERT_EQ(found, std::min<int>(kEdgeCostMax, chamfer(x - 8, y - 10)));
          } else if (apart >= 2) {
            ASSERT_EQ(found, kEdgeCostMax);
          }
        }
      }
    }
  }
}

TEST(SearchImages, EdgeCostIsTheDistanceToTheNearestOfTheEdgesThatCount) {
  for (const bool use_directions : {true, false}) {
    std::mt19937 random(5);
    MadeScene made(image::Image<float>(50, 44));
    for (int i = 0; i < 25; ++i) {  // on an octant's axis: in that channel alone
      made.add_edge(integer(random, 0, 49), integer(random, 0, 43),
                    integer(random, 0, 7) * kPi / 4.0);
    }
    ASSERT_EQ(made.build({.use_directions = use_directions}), Status::kOk);
    for (int octant = 0; octant < 8; ++octant) {
      for (int y = 0; y < 22; ++y) {
        for (int x = 0; x < 25; ++x) {
          int nearest = kEdgeCostMax;
          for (const image::EdgePoint& edge : made.edges) {
            if (!use_directions || image::octant_of(edge.dx, edge.dy) == octant)
              nearest = std::min(nearest, chamfer(edge.column / 2 - x, edge.row / 2 - y));
          }
          ASSERT_EQ(made.images.edge_cost(octant, x, y), nearest);
        }
      }
    }
  }
}

TEST(SearchImages, CreasesAreNoContours) {
  for (const bool use_directions : {true, false}) {
    MadeScene made(image::Image<float>(20, 20));
    made.add_edge(10, 10, 0.0, image::EdgeKind::kCrease);
    ASSERT_EQ(made.build({.use_directions = use_directions}), Status::kOk);
    for (int octant = 0; octant < 8; ++octant)
      EXPECT_EQ(made.images.edge_cost(octant, 5, 5), kEdgeCostMax);
  }
}

TEST(SearchImages, ReadHalfAnEdgeAndSomethingHigherOutsideTheField) {
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    for (const bool use_height : {true, false}) {
      MadeScene made(image::random_image(23, 17, 6));
      made.add_edge(0, 0, 0.3);
      ASSERT_EQ(made.build({.stride_px = stride_px, .reach_px = 12, .use_height = use_height}),
                Status::kOk);
      for (int y = -12; y < made.height_px() + 12; ++y) {
        for (int x = -12; x < made.width() + 12; ++x) {
          const bool inside = x >= 0 && y >= 0 && x < made.width() && y < made.height_px();
          for (int octant = 0; octant < 8 && !inside; ++octant)
            ASSERT_EQ(made.images.edge_cost(octant, x, y), kEdgeCostUnknown);
          ASSERT_EQ(made.images.at(SearchImages::kSurfaceImage, x, y) == kOutsideUnit, !inside);
        }
      }
    }
  }
}

TEST(SearchImages, HaveMemoryForEveryConfig) {
  for (const auto& [w, h] : {std::pair{2, 2}, {127, 129}, {130, 7}, {257, 300}, {3, 600}}) {
    MadeScene made{image::Image<float>(w, h)};
    for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
      for (const int reach_px : {-5, 0, 1, 50, kReachMax_px - 1, kReachMax_px, 1'000'000}) {
        ASSERT_EQ(made.build({.stride_px = stride_px, .reach_px = reach_px}), Status::kOk);
        EXPECT_LE(SearchImages::kImageCountMax * made.images.lattice.image_bytes(),
                  made.images.bytes.size());
        EXPECT_LE(made.images.lattice.reach_px(), kReachMax_px);
      }
    }
  }
}

TEST(SearchImages, OfASceneWithNothingInItFail) {
  MadeScene made(image::Image<float>(20, 20, kNan));
  EXPECT_EQ(made.build(), Status::kTooFewPoints);
}

TEST(SearchImages, OfTheSmallestMapsAreSound) {
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 1}, {1, 3}, {3, 3}, {2, 40}}) {
    for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
      for (const bool use_height : {true, false}) {
        MadeScene made(image::random_image(w, h, 8));
        made.add_edge(w - 1, h - 1, 0.0);
        ASSERT_EQ(made.build({.stride_px = stride_px, .use_height = use_height}), Status::kOk);
        EXPECT_EQ(made.images.edge_cost(0, made.width() - 1, made.height_px() - 1), 0);
      }
    }
  }
}

TEST(SearchImages, RefuseBadArguments) {
  MadeScene made(image::Image<float>(20, 20));
  for (const int stride_px : {0, -1, kStrideMax_px + 1}) {
    EXPECT_EQ(made.build({.stride_px = stride_px}), Status::kInvalidArgument);
  }
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    EXPECT_EQ(made.build({.height_tolerance_mm = bad}), Status::kInvalidArgument);
    EXPECT_EQ(made.build({.normal_tolerance_rad = bad}), Status::kInvalidArgument);
  }
}

TEST(SearchImages, RefuseEdgesThatDoNotGoByRows) {
  MadeScene made(image::Image<float>(20, 20));
  ASSERT_EQ(made.build(), Status::kOk);
  made.add_edge(3, 9, 0.0);
  made.add_edge(3, 8, 0.0);
  made.scene.edges = made.edges;
  EXPECT_EQ(build_search_images(made.scene, {}, {}, made.memory.arena, made.images),
            Status::kInvalidArgument);
}

TEST(SearchImages, FailInTooLittleScratch) {
  for (const bool use_height : {true, false}) {
    MadeScene made(image::random_image(60, 50, 9));
    for (int i = 0; i < 60 * 50 / 4; ++i) made.add_edge(i % 60, i / 60, 0.1 * i);
    made.scene.edges = made.edges;
    const SearchImagesConfig config{.use_height = use_height};
    for (const std::size_t size_bytes : {0U, 64U, 200U, 500U}) {  // less than a byte a cell
      Memory little(size_bytes);
      EXPECT_EQ(halve_heights(made.scene, 1.0, little.arena, made.images), Status::kOutOfMemory);
      EXPECT_EQ(build_search_images(made.scene, config, {}, little.arena, made.images),
                Status::kOutOfMemory);
      EXPECT_EQ(little.arena.used_bytes(), 0U);
    }
  }
}

}  // namespace
}  // namespace flatpose::search
