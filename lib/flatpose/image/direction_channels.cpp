#include "flatpose/image/direction_channels.hpp"

#include <algorithm>

#include "flatpose/image/chamfer.hpp"

namespace flatpose::image {
namespace {

struct Direction {
  float x;
  float y;
};
constexpr float kDiagonal = 0.70710678F;
constexpr std::array<Direction, kOctantCount> kOctantCentre = {{{1.0F, 0.0F},
                                                                {kDiagonal, kDiagonal},
                                                                {0.0F, 1.0F},
                                                                {-kDiagonal, kDiagonal},
                                                                {-1.0F, 0.0F},
                                                                {-kDiagonal, -kDiagonal},
                                                                {0.0F, -1.0F},
                                                                {kDiagonal, -kDiagonal}}};

void draw(const EdgePoint& edge, float cos_half_width, const OctantImages& masks) noexcept {
  for (int k = 0; k < kOctantCount; ++k) {
    const float cosine = edge.dx * kOctantCentre[k].x + edge.dy * kOctantCentre[k].y;
    if (cosine >= cos_half_width) masks[k](edge.column, edge.row) = 1;
  }
  // Rounding must not lose an edge that lies between two octants.
  masks[octant_of(edge.dx, edge.dy)](edge.column, edge.row) = 1;
}

}  // namespace

Status draw_direction_channels(std::span<const EdgePoint> edges, const ChannelConfig& config,
                               const OctantImages& masks) noexcept {
  constexpr double kRounding = 1e-9;
  if (!(config.half_width_rad >= kPi / kOctantCount - kRounding && config.half_width_rad <= kPi)) {
    return Status::kInvalidArgument;
  }
  for (const auto& mask : masks) {
    if (!same_shape(mask, masks[0])) return Status::kShapeMismatch;
    for (int y = 0; y < mask.height_px; ++y) {
      std::fill_n(mask.row(y), mask.width_px, std::uint8_t{0});
    }
  }
  const auto cos_half_width = static_cast<float>(sin_cos(config.half_width_rad).cos);
  for (const EdgePoint& edge : edges) {
    if (edge.kind == EdgeKind::kNone || !masks[0].contains(edge.column, edge.row)) continue;
    if (edge.kind == EdgeKind::kCrease && !config.with_creases) continue;
    draw(edge, cos_half_width, masks);
  }
  return Status::kOk;
}

Status chamfer_channels(const OctantImages& masks, const OctantImages& distance_third_px) noexcept {
  for (int k = 0; k < kOctantCount; ++k) {
    const Status status = chamfer_distance(masks[k], distance_third_px[k]);
    if (status != Status::kOk) return status;
  }
  return Status::kOk;
}

}  // namespace flatpose::image
