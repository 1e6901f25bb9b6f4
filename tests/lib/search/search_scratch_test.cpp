// The scratch that the search asks for, against what its stages take on maps of all proportions.

#include <gtest/gtest.h>

#include "flatpose/search/grid_search.hpp"
#include "tests/lib/search/made_field.hpp"
#include "tests/lib/search/made_parts.hpp"
#include "tests/lib/search/made_scene_images.hpp"

namespace flatpose::search {
namespace {

/// From heights to candidates at the widest window, with no other scratch than what was reserved.
void search_in(Memory& scratch, MadeScene& made, const SearchImagesConfig& config) {
  Arena& arena = scratch.arena;
  MadeField field(made.width(), made.height_px());
  MadePlaces places(made.width(), made.height_px());
  std::mt19937 random(2);
  const auto part = random_part(random, 5.0);
  std::vector<Candidate> candidates(3);
  ASSERT_EQ(halve_heights(made.scene, 1.0, arena, made.images), Status::kOk);
  ASSERT_EQ(fit_tilt_field(made.images.filled_mm, 1.0, kTiltWindowRadiusMax_px, arena, field.field,
                           config.stride_px),
            Status::kOk);
  ASSERT_EQ(collect_places(field.field, {.stride_px = config.stride_px}, places.places),
            Status::kOk);
  ASSERT_EQ(build_search_images(made.scene, config, {}, arena, made.images), Status::kOk);
  set_heights(field.field, made.images, places.places);
  ASSERT_EQ(grid_search(made.images, field.field, places.places, *part, 0, {}, arena, candidates)
                .status(),
            Status::kOk);
  ASSERT_EQ(arena.used_bytes(), 0U) << "the scratch is given back";
}

TEST(SearchScratch, ReservedIsExactlyWhatTheStagesTakeAtMost) {
  for (const auto& [w, h] :
       {std::pair{1, 1}, {5, 3}, {9000, 2}, {4, 1500}, {500, 400}, {129, 131}}) {
    SCOPED_TRACE(testing::Message() << w << 'x' << h);
    MadeScene made(image::random_image(w, h, 1));
    Arena measuring = Arena::measuring();
    reserve_search_scratch(measuring, made.scene.map.grid);
    Memory scratch(measuring.required_bytes());
    for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
      for (const bool use_height : {true, false})
        search_in(scratch, made, {.stride_px = stride_px, .use_height = use_height});
    }
    EXPECT_EQ(scratch.arena.peak_bytes(), measuring.peak_bytes());
  }
}

}  // namespace
}  // namespace flatpose::search
