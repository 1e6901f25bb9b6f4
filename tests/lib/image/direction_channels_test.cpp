#include "flatpose/image/direction_channels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flatpose/image/chamfer.hpp"
#include "tests/lib/image/image.hpp"

namespace flatpose::image {
namespace {

struct Channels {
  std::vector<Image<std::uint8_t>> images;
  OctantImages views;
  Channels(int w, int h) : images(kOctantCount, Image<std::uint8_t>(w, h, 9)) {
    for (int k = 0; k < kOctantCount; ++k) views[k] = images[static_cast<std::size_t>(k)].view();
  }
};

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

TEST(DirectionChannels, DrawAnEdgeInEveryOctantWithinTheAngleAndNoOther) {
  Channels masks(5, 4);
  for (const double half_width : {22.5, 37.5, 67.5, 180.0}) {
    for (double degree = 0.25; degree < 360.0; degree += 1.0) {
      const EdgePoint edge = edge_toward(degree * kRadPerDeg);
      const ChannelConfig config{half_width * kRadPerDeg, false};
      ASSERT_EQ(draw_direction_channels({&edge, 1}, config, masks.views), Status::kOk);
      for (int k = 0; k < kOctantCount; ++k) {
        const double off = std::fabs(std::remainder(degree - 45.0 * k, 360.0));
        for (int y = 0; y < 4; ++y) {
          for (int x = 0; x < 5; ++x) {
            const bool here = x == 2 && y == 1;
            ASSERT_EQ(masks.views[k](x, y), here && off <= half_width ? 1 : 0)
                << degree << " " << k;
          }
        }
      }
    }
  }
}

TEST(DirectionChannels, LeaveCreasesOutUnlessAsked) {
  Channels masks(5, 4);
  const EdgePoint crease = edge_toward(0.0, EdgeKind::kCrease);
  ASSERT_EQ(draw_direction_channels({&crease, 1}, {}, masks.views), Status::kOk);
  EXPECT_EQ(masks.images[0](2, 1), 0);
  ChannelConfig config;
  config.with_creases = true;
  ASSERT_EQ(draw_direction_channels({&crease, 1}, config, masks.views), Status::kOk);
  EXPECT_EQ(masks.images[0](2, 1), 1);
}

TEST(DirectionChannels, IgnoreEdgesOutsideAndRefuseBadInput) {
  Channels masks(5, 4);
  EdgePoint edge = edge_toward(0.0);
  edge.column = 5;
  EXPECT_EQ(draw_direction_channels({&edge, 1}, {}, masks.views), Status::kOk);
  EXPECT_EQ(draw_direction_channels({&edge, 1}, {0.3, false}, masks.views),
            Status::kInvalidArgument);
  EXPECT_EQ(draw_direction_channels({&edge, 1}, {NAN, false}, masks.views),
            Status::kInvalidArgument);
  Image<std::uint8_t> other(4, 4);
  masks.views[7] = other.view();
  EXPECT_EQ(draw_direction_channels({&edge, 1}, {}, masks.views), Status::kShapeMismatch);
}

TEST(DirectionChannels, ChamferEachMask) {
  Channels masks(40, 30);
  Channels distances(40, 30);
  std::vector<EdgePoint> edges;
  for (int i = 0; i < 30; ++i) {
    edges.push_back(edge_toward(0.7 * i));
    edges.back().column = static_cast<std::int16_t>((7 * i) % 40);
    edges.back().row = static_cast<std::int16_t>(i);
  }
  ASSERT_EQ(draw_direction_channels(edges, {}, masks.views), Status::kOk);
  ASSERT_EQ(chamfer_channels(masks.views, distances.views), Status::kOk);
  for (int k = 0; k < kOctantCount; ++k) {
    Image<std::uint8_t> alone(40, 30);
    ASSERT_EQ(chamfer_distance(masks.views[k], alone.view()), Status::kOk);
    EXPECT_EQ(alone, distances.images[static_cast<std::size_t>(k)]);
  }
}

}  // namespace
}  // namespace flatpose::image
