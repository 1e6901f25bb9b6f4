#include "flatpose/image/direction_channels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "flatpose/image/chamfer.hpp"
#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

using Cells = Image<OctantCell>;

Status measure(std::span<const EdgePoint> edges, const ChannelConfig& config, Cells& out) {
  return edge_distances(edges, config, {out.view()});
}

EdgePoint edge_toward(double angle_rad, EdgeKind kind = EdgeKind::kJump) {
  EdgePoint edge;
  edge.dx = static_cast<float>(std::cos(angle_rad));
  edge.dy = static_cast<float>(std::sin(angle_rad));
  edge.column = 2;
  edge.row = 1;
  edge.kind = kind;
  return edge;
}

TEST(Octant, IsTheNearestOfTheEightDirections) {
  for (int degree = 0; degree < 3600; ++degree) {
    if (degree % 450 == 225) continue;  // between two
    const EdgePoint edge = edge_toward(degree * kPi / 1800.0);
    EXPECT_EQ(octant_of(edge.dx, edge.dy), ((degree + 225) / 450) % 8) << degree;
  }
}

TEST(EdgeDistances, CountAnEdgeInEveryOctantWithinTheAngleAndNoOther) {
  Cells cells(5, 4);
  for (const double half_width : {22.5, 37.5, 67.5, 180.0}) {
    for (double degree = 0.25; degree < 360.0; degree += 1.0) {
      const EdgePoint edge = edge_toward(degree * kRadPerDeg);
      ASSERT_EQ(measure({&edge, 1}, {half_width * kRadPerDeg}, cells), Status::kOk);
      for (int k = 0; k < kOctantCount; ++k) {
        const double off = std::fabs(std::remainder(degree - 45.0 * k, 360.0));
        const OctantChannel channel = OctantImage{cells.view()}[k];
        ASSERT_EQ(channel(2, 1), off <= half_width ? 0 : kOctantDistanceMax_third_px)
            << degree << " " << k;
        ASSERT_EQ(channel(4, 2), off <= half_width ? 7 : kOctantDistanceMax_third_px);
      }
    }
  }
}

TEST(EdgeDistances, LeaveCreasesOutUnlessAsked) {
  Cells cells(5, 4);
  const EdgePoint crease = edge_toward(0.0, EdgeKind::kCrease);
  ASSERT_EQ(measure({&crease, 1}, {}, cells), Status::kOk);
  EXPECT_EQ(cells(2, 1).of[0], kOctantDistanceMax_third_px);
  ChannelConfig config;
  config.with_creases = true;
  ASSERT_EQ(measure({&crease, 1}, config, cells), Status::kOk);
  EXPECT_EQ(cells(2, 1).of[0], 0);
}

TEST(EdgeDistances, IgnoreEdgesOutside) {
  Cells cells(5, 4);
  std::vector<EdgePoint> edges(5, edge_toward(0.0));
  edges[0].row = -1;
  edges[1].column = 5;
  edges[2].column = -1;
  edges[3].kind = EdgeKind::kNone;
  edges[4].row = 4;
  ASSERT_EQ(measure(edges, {}, cells), Status::kOk);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (const int distance : cells(x, y).of) ASSERT_EQ(distance, kOctantDistanceMax_third_px);
    }
  }
}

TEST(EdgeDistances, RefuseBadInput) {
  Cells cells(5, 4);
  std::vector<EdgePoint> edges(2, edge_toward(0.0));
  for (const double bad_width : {0.3, 3.2, static_cast<double>(NAN)})
    EXPECT_EQ(measure(edges, {bad_width}, cells), Status::kInvalidArgument);
  ChannelConfig config;
  config.edge_cells = 0;
  EXPECT_EQ(measure(edges, config, cells), Status::kInvalidArgument);
  config = {};
  for (const int bad_max : {0, 241, 255}) {
    config.distance_max_third_px = static_cast<std::uint8_t>(bad_max);
    EXPECT_EQ(measure(edges, config, cells), Status::kInvalidArgument);
  }
  edges[0].row = 2;
  EXPECT_EQ(measure(edges, {}, cells), Status::kInvalidArgument) << "not by rows";
  Cells none(0, 0);
  EXPECT_EQ(measure({}, {}, none), Status::kOk);
}

std::vector<EdgePoint> random_edges(int count, int side, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_int_distribution<int> place(0, side - 1);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * kPi);
  std::vector<EdgePoint> edges;
  for (int i = 0; i < count; ++i) {
    edges.push_back(edge_toward(angle(generator)));
    edges.back().column = static_cast<std::int16_t>(place(generator));
    edges.back().row = static_cast<std::int16_t>(place(generator));
  }
  std::sort(edges.begin(), edges.end(),
            [](const EdgePoint& a, const EdgePoint& b) { return a.row < b.row; });
  return edges;
}

// The chamfer distance of chamfer.hpp to the edges of one octant, found one cell at a time.
Image<std::uint8_t> alone(std::span<const EdgePoint> edges, const ChannelConfig& config, int octant,
                          int width_px, int height_px) {
  Image<std::uint8_t> mask(width_px, height_px);
  for (const EdgePoint& edge : edges) {
    const double angle = std::atan2(edge.dy, edge.dx) - octant * kPi / 4.0;
    if (std::fabs(std::remainder(angle, 2.0 * kPi)) > config.half_width_rad) continue;
    const int x = edge.column / config.edge_cells;
    const int y = edge.row / config.edge_cells;
    if (x < width_px && y < height_px) mask(x, y) = 1;
  }
  Image<std::uint8_t> distance(width_px, height_px);
  EXPECT_EQ(chamfer_distance(mask.view(), distance.view()), Status::kOk);
  return distance;
}

TEST(EdgeDistances, AreTheChamferDistanceOfEachDirectionAtEverySize) {
  unsigned seed = 0;
  for (const int w : {1, 2, 3, 5, 8, 17, 33, 90}) {
    for (const int h : {1, 2, 3, 7, 16, 90}) {
      for (const int edge_cells : {1, 2}) {
        ChannelConfig config;
        config.edge_cells = edge_cells;
        config.distance_max_third_px = seed % 2 == 0 ? 240 : 15;
        const auto edges = random_edges(std::max(w, h), edge_cells * std::max(w, h), ++seed);
        Cells cells(w, h);
        ASSERT_EQ(measure(edges, config, cells), Status::kOk);
        for (int k = 0; k < kOctantCount; ++k) {
          const Image<std::uint8_t> expected = alone(edges, config, k, w, h);
          for (int y = 0; y < h; ++y) {
            for (int x = 0; x < w; ++x) {
              ASSERT_EQ(OctantImage{cells.view()}[k](x, y),
                        std::min(expected(x, y), config.distance_max_third_px))
                  << w << "x" << h << " octant " << k << " at " << x << "," << y;
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace flatpose::image
