#pragma once
// A scene made by hand, heights and edges without any rectification behind them, and the search
// images of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "flatpose/search/grid_search.hpp"
#include "flatpose/search/search_images.hpp"
#include "tests/lib/image/image.hpp"
#include "tests/lib/search/memory.hpp"

namespace flatpose::search {

struct MadeScene {
  static constexpr double kAnyJump_mm = 1e6;

  image::Image<float> height;
  std::vector<image::EdgePoint> edges;
  scene::Scene scene;
  Memory memory;
  SearchImages images;

  explicit MadeScene(const image::Image<float>& heights, double cell_mm = 0.5)
      : height(heights),
        scene(scene_of(height, cell_mm)),
        memory(required_bytes(scene.map.grid)),
        images(take_search_images(memory.arena, scene.map.grid)) {}
  MadeScene(const MadeScene&) = delete;
  MadeScene& operator=(const MadeScene&) = delete;

  void add_edge(int column, int row, double angle_rad,
                image::EdgeKind kind = image::EdgeKind::kJump) {
    edges.push_back({static_cast<float>(column), static_cast<float>(row),
                     static_cast<float>(std::cos(angle_rad)),
                     static_cast<float>(std::sin(angle_rad)), 3.0F,
                     static_cast<std::int16_t>(column), static_cast<std::int16_t>(row), kind});
  }
  Status build(const SearchImagesConfig& config = {}, const HeightRange& range = {-10.0, 10.0},
               double jump_mm = kAnyJump_mm) {
    std::stable_sort(edges.begin(), edges.end(),
                     [](const auto& a, const auto& b) { return a.row < b.row; });
    scene.edges = edges;
    const std::size_t used_bytes = memory.arena.used_bytes();
    Status status = halve_heights(scene, jump_mm, memory.arena, images);
    if (status == Status::kOk)
      status = build_search_images(scene, config, range, memory.arena, images);
    EXPECT_EQ(memory.arena.used_bytes(), used_bytes) << "the scratch is given back";
    return status;
  }
  [[nodiscard]] int width() const { return images.grid.width_px; }
  [[nodiscard]] int height_px() const { return images.grid.height_px; }

 private:
  static scene::Scene scene_of(image::Image<float>& heights, double cell_mm) {
    scene::Scene made;
    made.map.grid = {-7.0, 3.0, cell_mm, heights.width(), heights.height()};
    made.map.height_mm = heights.view();
    return made;
  }
  static std::size_t required_bytes(const rectify::Grid& grid) {
    Arena measuring = Arena::measuring();
    (void)take_search_images(measuring, grid);
    reserve_search_scratch(measuring, grid);
    return measuring.required_bytes();
  }
};

}  // namespace flatpose::search
