#include "flatpose/scene/scene.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/image/canny.hpp"
#include "flatpose/image/dark_pit.hpp"
#include "flatpose/image/fill.hpp"

namespace flatpose::scene {
namespace {

image::EdgeConfig edge_config(const SceneConfig& config) noexcept {
  constexpr double kLowShare = 0.6;
  const double high_mm = edge_threshold_mm(config);
  image::EdgeConfig edges;
  edges.jump_high_mm = static_cast<float>(high_mm);
  edges.jump_low_mm = static_cast<float>(kLowShare * high_mm);
  return edges;
}

image::DarkPitConfig pit_config(const SceneConfig& config) noexcept {
  const double level_mm = edge_threshold_mm(config);
  return {static_cast<float>(level_mm),
          static_cast<float>(std::max(config.step_mm, 2.0 * level_mm))};
}

rectify::RectifyConfig rectify_config(const SceneConfig& config, double cell_mm) noexcept {
  // Steps that are contours are not bridged by a wall; noise and slopes are.
  constexpr double kPitchesPerGap = 3.5;
  // What is left of a fine scan is still somewhat finer than the map.
  constexpr double kCellsPerStep = 0.8;
  rectify::RectifyConfig rectified;
  rectified.method = config.method;
  const double step_px = std::floor(kCellsPerStep * cell_mm / config.pitch_mm);
  rectified.paint.step_px =
      static_cast<int>(std::max(1.0, std::min(step_px, 1.0 * rectify::kStepMax_px)));
  rectified.paint.jump_mm = edge_threshold_mm(config);
  rectified.paint.max_gap_mm = kPitchesPerGap * rectified.paint.step_px * config.pitch_mm;
  rectified.paint.vector_path = config.vector_path;
  rectified.paint.reach = config.reach;
  return rectified;
}

}  // namespace

double edge_threshold_mm(const SceneConfig& config) noexcept {
  // Five standard deviations keep noise out; with the part's step known, less than half of it is
  // clutter.
  constexpr double kNoiseFactor = 5.0;
  constexpr double kStepShare = 0.4;
  return std::max(kNoiseFactor * config.noise_mm, kStepShare * config.step_mm);
}

Scene take_scene(Arena& arena, const rectify::Grid& grid,
                 std::span<image::EdgePoint>& edge_memory) noexcept {
  Scene scene;
  scene.map.grid = grid;
  scene.map.height_mm = arena.take_image<float>(grid.width_px, grid.height_px);
  scene.map.source_index = arena.take_image<std::int32_t>(grid.width_px, grid.height_px);
  scene.filled_mm = arena.take_image<float>(grid.width_px, grid.height_px);
  scene.missing = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  scene.edge_kind = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  const std::size_t cell_count =
      static_cast<std::size_t>(grid.width_px) * static_cast<std::size_t>(grid.height_px);
  edge_memory = arena.take<image::EdgePoint>(cell_count / kCellsPerEdge + 1);
  return scene;
}

Status build_scene(const RangeImageView& scan, const Frames& frames, const rectify::Grid& grid,
                   const SceneConfig& config, Arena& arena, Scene& scene,
                   const Budget& budget) noexcept {
  std::span<image::EdgePoint> edge_memory;
  scene = take_scene(arena, grid, edge_memory);
  if (arena.failed()) return Status::kOutOfMemory;
  scene.noise_mm = config.noise_mm;
  scene.pitch_mm = config.pitch_mm;
  scene.vector_path = config.vector_path;
  if (const Status s = rectify::rectify(
          scan, frames.work_T_scan, rectify_config(config, grid.cell_mm), arena, scene.map, budget);
      s != Status::kOk) {
    return s;
  }
  const Status filled = image::fill_missing(scene.map.height_mm, scene.filled_mm, scene.missing,
                                            arena, config.vector_path, budget);
  if (filled != Status::kOk) return filled;
  if (const Status s = image::lower_dark_pits(pit_config(config), arena, scene.missing,
                                              scene.filled_mm, config.vector_path, budget);
      s != Status::kOk) {
    return s;
  }
  const Result<int> edge_count =
      image::detect_edges(scene.filled_mm, scene.missing, grid.cell_mm, edge_config(config), arena,
                          scene.edge_kind, edge_memory, config.vector_path, budget);
  if (!edge_count) return edge_count.status();
  scene.edges = edge_memory.first(static_cast<std::size_t>(*edge_count));
  return Status::kOk;
}

}  // namespace flatpose::scene
