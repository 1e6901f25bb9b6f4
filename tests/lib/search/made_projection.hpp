#pragma once
// Projected templates made by hand: any shift within reach, any octant, rise and normal.

#include <random>

#include "flatpose/search/score.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {

inline ProjectedTemplate random_projection(std::mt19937& random, const SearchImages& images) {
  const auto small = [&](int low, int high) {
    return static_cast<std::int16_t>(integer(random, low, high));
  };
  const int reach_px = images.lattice.reach_px();
  const auto shift = [&] { return small(-reach_px, reach_px); };
  // Mostly near the ground, sometimes so far that the expected height saturates.
  const auto rise = [&] {
    switch (random() % 8) {
      case 0: return small(-32767, 32767);
      case 1: return small(-kHeightUnitMax - 20, kHeightUnitMax + 20);
      default: return small(-12, 12);
    }
  };
  ProjectedTemplate t;
  t.contour_count = integer(random, 0, kContourCountMax);
  t.surface_count = integer(random, 0, kSurfaceCountMax);
  const std::int32_t factors_q8[] = {256, 257, integer(random, 256, kEdgeFactorMax_q8),
                                     kEdgeFactorMax_q8};
  t.edge_factor_q8 = factors_q8[random() % 4];
  for (auto& p : t.contour) p = {shift(), shift(), small(0, image::kOctantCount - 1), rise()};
  for (auto& p : t.surface)
    p = {shift(), shift(), rise(), small(0, 2 * kNormalZero), small(0, 2 * kNormalZero)};
  return t;
}

}  // namespace flatpose::search
