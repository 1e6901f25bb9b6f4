#include "flatpose/locate/workspace.hpp"

#include "flatpose/image/canny.hpp"
#include "flatpose/image/dark_pit.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/rectify/rectify.hpp"
#include "flatpose/rectify/survey.hpp"

namespace flatpose::locate {

Workspace take_workspace(Arena& arena, const rectify::Grid& grid) noexcept {
  Workspace work;
  work.fine = refine::take_fine_images(arena, grid);
  work.coarse = search::take_search_images(arena, grid);
  work.tilt = search::take_tilt_field(arena, work.coarse.grid.width_px, work.coarse.grid.height_px);
  work.places = search::take_places(arena, work.coarse.grid.width_px, work.coarse.grid.height_px);
  work.claimed = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  work.candidates = arena.take<search::Candidate>(kCandidateCountMax);
  work.instances = arena.take<Instance>(kInstanceCountMax);
  work.crossings = arena.take<refine::Crossing>(model::kContourPointCountMax);
  return work;
}

std::size_t workspace_required_bytes(const Limits& limits) noexcept {
  // The longest rows need the most scratch; a map of fewer, shorter rows needs less.
  rectify::Grid grid;
  grid.width_px = kMapSideMax_px;
  grid.height_px = limits.cell_count / kMapSideMax_px + 1;
  Arena arena = Arena::measuring();
  const auto with_scratch = [&arena](auto&& reserve) {
    const ArenaScope scope(arena);
    reserve();
  };
  with_scratch([&] { (void)arena.take<std::byte>(rectify::survey_required_bytes()); });
  std::span<image::EdgePoint> edge_memory;
  (void)scene::take_scene(arena, grid, edge_memory);
  for (const auto method : {rectify::Method::kPaint, rectify::Method::kBucket}) {
    with_scratch([&] {
      (void)arena.take<std::byte>(
          rectify::required_bytes(method, limits.scan_width_px, limits.scan_height_px, grid));
    });
  }
  with_scratch([&] { image::reserve_fill_scratch(arena, grid.width_px); });
  with_scratch([&] { image::reserve_dark_pit_scratch(arena, grid.width_px, grid.height_px); });
  with_scratch([&] { image::reserve_edge_scratch(arena, grid.width_px, grid.height_px); });
  (void)take_workspace(arena, grid);
  with_scratch([&] { search::reserve_search_scratch(arena, grid); });
  return arena.required_bytes();
}

}  // namespace flatpose::locate
