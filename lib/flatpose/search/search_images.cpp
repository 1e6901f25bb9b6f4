#include "flatpose/search/search_images.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/image/direction_channels.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/image/normals.hpp"
#include "flatpose/image/pyramid.hpp"

namespace flatpose::search {
namespace {

double middle_height(ImageView<const float> filled_mm) noexcept {
  float low = filled_mm(0, 0);
  float high = low;
  for (int y = 0; y < filled_mm.height_px; ++y) {
    const float* row = filled_mm.row(y);
    for (int x = 0; x < filled_mm.width_px; ++x) {
      low = std::min(low, row[x]);
      high = std::max(high, row[x]);
    }
  }
  return 0.5 * (static_cast<double>(low) + static_cast<double>(high));
}

void quantise_heights(const SearchImages& images) noexcept {
  for (int y = 0; y < images.grid.height_px; ++y) {
    const float* filled_mm = images.filled_mm.row(y);
    std::int16_t* unit = images.height_unit.row(y);
    for (int x = 0; x < images.grid.width_px; ++x) {
      const double value = std::floor(
          (static_cast<double>(filled_mm[x]) - images.base_mm) * kHeightUnitsPerMm + 0.5);
      unit[x] = static_cast<std::int16_t>(std::clamp(value, -kHeightUnitMax, kHeightUnitMax));
    }
  }
}

Status quantise_normals(const SearchImages& images, Arena& scratch) noexcept {
  const ArenaScope scope(scratch);
  const ImageView<float> nx =
      scratch.take_image<float>(images.grid.width_px, images.grid.height_px);
  const ImageView<float> ny =
      scratch.take_image<float>(images.grid.width_px, images.grid.height_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  if (const Status s = image::normal_map(images.filled_mm, images.grid.cell_mm, nx, ny);
      s != Status::kOk)
    return s;
  const auto unit = [](float component) {
    return static_cast<std::int8_t>(
        std::floor(static_cast<double>(component) * kNormalUnits + 0.5));
  };
  for (int y = 0; y < images.grid.height_px; ++y) {
    for (int x = 0; x < images.grid.width_px; ++x) {
      images.normal_x_unit(x, y) = unit(nx(x, y));
      images.normal_y_unit(x, y) = unit(ny(x, y));
    }
  }
  return Status::kOk;
}

// The scene's edges at the coarse level: found where they are sharpest, drawn where they are
// needed.
Status build_edge_costs(const scene::Scene& scene, Arena& scratch,
                        const SearchImages& images) noexcept {
  const ArenaScope scope(scratch);
  const std::span<image::EdgePoint> edges = scratch.take<image::EdgePoint>(scene.edges.size());
  image::OctantImages masks;
  for (auto& mask : masks) {
    mask = scratch.take_image<std::uint8_t>(images.grid.width_px, images.grid.height_px);
  }
  if (scratch.failed()) return Status::kOutOfMemory;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    edges[i] = scene.edges[i];
    edges[i].column = static_cast<std::int16_t>(edges[i].column / 2);
    edges[i].row = static_cast<std::int16_t>(edges[i].row / 2);
  }
  if (const Status s = image::draw_direction_channels(edges, {}, masks); s != Status::kOk) return s;
  if (const Status s = image::chamfer_channels(masks, images.edge_cost); s != Status::kOk) return s;
  for (const ImageView<std::uint8_t>& cost : images.edge_cost) {
    for (int y = 0; y < cost.height_px; ++y) {
      std::uint8_t* row = cost.row(y);
      for (int x = 0; x < cost.width_px; ++x) row[x] = std::min(row[x], kEdgeCostMax);
    }
  }
  return Status::kOk;
}

}  // namespace

SearchImages take_search_images(Arena& arena, const rectify::Grid& fine) noexcept {
  SearchImages images;
  images.grid = image::halved(fine);
  const int width_px = images.grid.width_px;
  const int height_px = images.grid.height_px;
  images.filled_mm = arena.take_image<float>(width_px, height_px);
  images.missing = arena.take_image<std::uint8_t>(width_px, height_px);
  for (auto& cost : images.edge_cost) cost = arena.take_image<std::uint8_t>(width_px, height_px);
  images.height_unit = arena.take_image<std::int16_t>(width_px, height_px);
  images.normal_x_unit = arena.take_image<std::int8_t>(width_px, height_px);
  images.normal_y_unit = arena.take_image<std::int8_t>(width_px, height_px);
  return images;
}

Status build_search_images(const scene::Scene& scene, double jump_mm, Arena& scratch,
                           SearchImages& images) noexcept {
  Status s = image::halve(scene.map.height_mm, static_cast<float>(jump_mm), images.filled_mm);
  if (s != Status::kOk) return s;
  s = image::fill_missing(images.filled_mm, images.filled_mm, images.missing, scratch);
  if (s != Status::kOk) return s;
  images.base_mm = middle_height(images.filled_mm);
  quantise_heights(images);
  s = quantise_normals(images, scratch);
  return s == Status::kOk ? build_edge_costs(scene, scratch, images) : s;
}

}  // namespace flatpose::search
