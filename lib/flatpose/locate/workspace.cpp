#include "flatpose/locate/workspace.hpp"

#include <algorithm>

#include "flatpose/image/canny.hpp"
#include "flatpose/image/dark_pit.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/locate/features.hpp"
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
  work.starts = arena.take<Pose>(kStartCountMax);
  work.polish = refine::take_polish_scratch(arena);
  return work;
}

namespace {

std::size_t required_bytes_on(const rectify::Grid& grid, const Limits& limits) noexcept {
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
  with_scratch([&] { reserve_feature_scratch(arena, grid); });
  with_scratch([&] { search::reserve_search_scratch(arena, grid); });
  return arena.required_bytes();
}

}  // namespace

std::size_t workspace_required_bytes(const Limits& limits) noexcept {
  // Wide maps have long rows, narrow ones waste most of their blocks of places: between two widths
  // at which a row takes one block more, the memory is largest at one of the two.
  constexpr int kCellsPerBlock = 2 * search::kBlockSize;
  const int narrowest_px = std::clamp(limits.cell_count / kMapSideMax_px, 1, kMapSideMax_px);
  std::size_t most_bytes = 0;
  const auto include = [&](int width_px) {
    if (width_px < narrowest_px || width_px > kMapSideMax_px) return;
    rectify::Grid grid;
    grid.width_px = width_px;
    grid.height_px = std::min(limits.cell_count / width_px + 1, kMapSideMax_px);
    most_bytes = std::max(most_bytes, required_bytes_on(grid, limits));
  };
  include(narrowest_px);
  include(narrowest_px + 1);
  for (int width_px = kCellsPerBlock; width_px <= kMapSideMax_px; width_px += kCellsPerBlock) {
    include(width_px);
    include(width_px + 1);
  }
  return most_bytes;
}

}  // namespace flatpose::locate
