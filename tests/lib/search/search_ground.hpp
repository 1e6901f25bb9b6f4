#pragma once
// From a scene to all that the grid search reads, as locate does it.

#include <gtest/gtest.h>

#include "flatpose/search/grid_search.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {

struct SearchGround {
  Memory memory;
  SearchImages images;
  TiltField field;
  Places places;

  SearchGround(const scene::Scene& scene, const SearchImagesConfig& config,
               const PlaceConfig& gate = {}, int tilt_radius_px = 2)
      : memory(lay_out(Arena::measuring(), scene.map.grid).required_bytes()) {
    memory.arena = lay_out(memory.arena, scene.map.grid);
    memory.arena.rewind(kept_bytes_);
    const double jump_mm = 1.0;
    EXPECT_EQ(halve_heights(scene, jump_mm, memory.arena, images), Status::kOk);
    EXPECT_EQ(fit_tilt_field(images.filled_mm, images.grid.cell_mm, tilt_radius_px, memory.arena,
                             field, config.stride_px),
              Status::kOk);
    PlaceConfig place_config = gate;
    place_config.stride_px = config.stride_px;
    EXPECT_EQ(collect_places(field, place_config, places), Status::kOk);
    EXPECT_EQ(build_search_images(scene, config, places.range, memory.arena, images), Status::kOk);
    set_heights(field, images, places);
  }
  SearchGround(const SearchGround&) = delete;
  SearchGround& operator=(const SearchGround&) = delete;

 private:
  /// The arena with everything taken from it, scratch and all.
  Arena lay_out(Arena arena, const rectify::Grid& fine) {
    images = take_search_images(arena, fine);
    field = take_tilt_field(arena, images.grid.width_px, images.grid.height_px);
    places = take_places(arena, images.grid.width_px, images.grid.height_px);
    kept_bytes_ = arena.used_bytes();
    reserve_search_scratch(arena, fine);
    return arena;
  }

  std::size_t kept_bytes_ = 0;
};

}  // namespace flatpose::search
