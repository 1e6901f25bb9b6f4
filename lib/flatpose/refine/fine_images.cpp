#include "flatpose/refine/fine_images.hpp"

#include "flatpose/image/direction_channels.hpp"
#include "flatpose/image/normals.hpp"

namespace flatpose::refine {

FineImages take_fine_images(Arena& arena, const rectify::Grid& grid) noexcept {
  FineImages images;
  images.grid = grid;
  images.edge_distance_third_px.cells =
      arena.take_image<image::OctantCell>(grid.width_px, grid.height_px);
  images.normal_x = arena.take_image<float>(grid.width_px, grid.height_px);
  images.normal_y = arena.take_image<float>(grid.width_px, grid.height_px);
  return images;
}

Status begin_fine_images(const scene::Scene& scene, FineImages& images) noexcept {
  images.height_mm = scene.map.height_mm;
  images.filled_mm = scene.filled_mm;
  images.missing = scene.missing;
  return image::check_normal_map(scene.filled_mm, images.grid.cell_mm, images.normal_x,
                                 images.normal_y);
}

Status write_fine_distances(const scene::Scene& scene, FineImages& images,
                            const Budget& budget) noexcept {
  return image::edge_distances(scene.edges, {}, images.edge_distance_third_px, scene.vector_path,
                               budget);
}

Status build_fine_images(const scene::Scene& scene, FineImages& images) noexcept {
  if (const Status s = begin_fine_images(scene, images); s != Status::kOk) return s;
  if (const Status s = write_fine_distances(scene, images); s != Status::kOk) return s;
  return image::normal_map(scene.filled_mm, images.grid.cell_mm, images.normal_x, images.normal_y,
                           scene.vector_path);
}

}  // namespace flatpose::refine
