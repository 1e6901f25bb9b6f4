#include "flatpose/refine/fine_images.hpp"

#include <algorithm>

#include "flatpose/image/bspline.hpp"
#include "flatpose/image/normals.hpp"

namespace flatpose::refine {

FineImages take_fine_images(Arena& arena, const rectify::Grid& grid) noexcept {
  FineImages images;
  images.grid = grid;
  for (auto& distance : images.edge_distance_third_px) {
    distance = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  }
  for (auto& spline : images.edge_distance_spline) {
    spline = arena.take_image<float>(grid.width_px, grid.height_px);
  }
  images.normal_x = arena.take_image<float>(grid.width_px, grid.height_px);
  images.normal_y = arena.take_image<float>(grid.width_px, grid.height_px);
  return images;
}

void reserve_fine_scratch(Arena& arena, const rectify::Grid& grid) noexcept {
  for (int k = 0; k < image::kOctantCount; ++k) {
    (void)arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  }
}

Status build_fine_images(const scene::Scene& scene, Arena& scratch, FineImages& images) noexcept {
  images.height_mm = scene.map.height_mm;
  images.filled_mm = scene.filled_mm;
  const ArenaScope scope(scratch);
  image::OctantImages masks;
  for (auto& mask : masks)
    mask = scratch.take_image<std::uint8_t>(images.grid.width_px, images.grid.height_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  if (const Status s = image::draw_direction_channels(scene.edges, {}, masks); s != Status::kOk)
    return s;
  if (const Status s = image::chamfer_channels(masks, images.edge_distance_third_px);
      s != Status::kOk)
    return s;
  for (int k = 0; k < image::kOctantCount; ++k) {
    const ImageView<float>& spline = images.edge_distance_spline[k];
    for (int y = 0; y < images.grid.height_px; ++y) {
      const std::uint8_t* distance = images.edge_distance_third_px[k].row(y);
      float* out = spline.row(y);
      for (int x = 0; x < images.grid.width_px; ++x)
        out[x] = std::min(distance[x], kEdgeDistanceMax_third_px);
    }
    image::bspline_prefilter(spline);
  }
  return image::normal_map(scene.filled_mm, images.grid.cell_mm, images.normal_x, images.normal_y);
}

}  // namespace flatpose::refine
