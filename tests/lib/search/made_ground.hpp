#pragma once
// Ground made by hand, level or sloped, with random evidence on it, and the grid search run there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "flatpose/search/grid_search.hpp"
#include "tests/lib/search/made_field.hpp"
#include "tests/lib/search/made_images.hpp"
#include "tests/lib/search/made_parts.hpp"

namespace flatpose::search {

inline int searched_angles(const model::Template& part, const GridSearchConfig& config) {
  return angle_count(angle_range_rad(part.symmetry, part.anchors[0]), config.angle_step_rad);
}

struct Found {
  Status status = Status::kOk;
  GridSearchResult result;
  std::vector<Candidate> candidates;
};

/// The scratch that the search says it takes on a coarse level of this size.
inline std::size_t scratch_bytes(const rectify::Grid& coarse, bool with_nodes = false) {
  rectify::Grid fine = coarse;
  fine.width_px *= 2;
  fine.height_px *= 2;
  Arena measuring = Arena::measuring();
  reserve_search_scratch(measuring, fine, with_nodes);
  return measuring.required_bytes();
}

struct MadeGround {
  MadeImages made;
  MadeField field;
  MadePlaces places;

  MadeGround(int width_px, int height_px, const SearchImagesConfig& config = {1, 24})
      : made(width_px, height_px, config), field(width_px, height_px), places(width_px, height_px) {
    collect();
  }
  void collect(const PlaceConfig& gate = {}) {
    PlaceConfig config = gate;
    config.stride_px = made.images.lattice.stride_px;
    ASSERT_EQ(collect_places(field.field, config, places.places), Status::kOk);
    set_heights(field.field, made.images, places.places);
  }
  /// Writes a plane through height 0 in the middle, into the field and the heights.
  void lay_plane(double slope_x, double slope_y) {
    field.for_each([&](int x, int y) {
      const double z_mm = slope_x * (x - made.width() / 2) + slope_y * (y - made.height_px() / 2);
      field.slope_x(x, y) = static_cast<float>(slope_x);
      field.slope_y(x, y) = static_cast<float>(slope_y);
      field.plane_mm(x, y) = static_cast<float>(z_mm);
      made.height(x, y) = height_unit(z_mm, made.images);
    });
  }
  [[nodiscard]] Found run(const model::Template& part, const GridSearchConfig& config,
                          std::size_t capacity = 2000, Executor& executor = callers_thread) const {
    Found found;
    found.candidates.resize(capacity);
    Memory scratch(scratch_bytes(made.images.grid, made.images.nodes.side > 0));
    const Result<GridSearchResult> result =
        grid_search(made.images, field.field, places.places, part, 0, config, scratch.arena,
                    found.candidates, executor);
    EXPECT_EQ(scratch.arena.used_bytes(), 0U) << "the scratch is given back";
    found.status = result.status();
    if (result) found.result = *result;
    found.candidates.resize(static_cast<std::size_t>(found.result.candidate_count));
    return found;
  }
};

inline GridSearchConfig made_config(std::mt19937& random) {
  GridSearchConfig config;
  config.score = {integer(random, 1, 10), integer(random, 0, 6)};
  config.angle_step_rad = uniform(random, 0.2, 0.9);
  config.cost_share_max = random() % 2 == 0 ? 1.0 : uniform(random, 0.3, 0.9);
  config.first_share = uniform(random, 0.1, 1.2);
  return config;
}

/// Level ground, or slopes that change from patch to patch; rubble between the patches. The fewer
/// `levels` of evidence, the more hypotheses cost the same.
template <class Check>
void over_random_grounds(unsigned seed, double slope_max, int levels, const Check& check) {
  std::mt19937 random(seed);
  for (int trial = 0; trial < 32; ++trial) {
    // With little reach some points are left out, at some angles more than at others.
    SearchImagesConfig images{1 + trial % kStrideMax_px, integer(random, 3, 20)};
    images.use_height = trial / 4 % 4 != 3;
    images.use_directions = trial / 4 % 4 != 2;
    images.node_side = std::array{0, 2, 4}[trial % 3];
    images.node_slack = images.node_side > 0 && images.stride_px == 1 ? trial / 4 % 3 : 0;
    MadeGround ground(integer(random, 1, 24 * images.stride_px),
                      integer(random, 1, 12 * images.stride_px), images);
    ground.made.randomise(random, levels);
    const double turn_rad = uniform(random, -kPi, kPi);
    ground.field.for_each([&](int x, int y) {
      const int patch = x / 9 + 5 * (y / 7);
      ground.field.set_slope(x, y, slope_max * (patch % 4) / 3.0, turn_rad + patch);
      ground.field.plane_mm(x, y) = static_cast<float>(uniform(random, -40.0, 40.0));
      if (x % 9 == 0 || y % 7 == 0) ground.field.rms_mm(x, y) = 0.9F;
    });
    ground.collect({.max_tilt_rad = 1.2});
    const auto part = random_part(random, 9.0);
    if (random() % 2 == 0) part->anchors[0] = {static_cast<float>(uniform(random, -3, 3)), 1, 2};
    part->symmetry.order = std::array{1, 2, 4, model::kFullSymmetry}[random() % 4];
    check(ground, *part, made_config(random));
    if (testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace flatpose::search
