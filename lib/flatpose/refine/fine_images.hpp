#pragma once
// What the refinement reads: the finest level as continuous images (Ingberg 2015, 2.7, 2.11).

#include <algorithm>
#include <cstdint>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/image/octant_image.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::refine {

inline constexpr std::uint8_t kEdgeDistanceMax_third_px =
    60;  ///< Beyond 20 cells a nearer edge is another part's.

struct FineImages {
  rectify::Grid grid;
  ImageView<const float> height_mm;  ///< NaN where missing.
  ImageView<const float> filled_mm;
  ImageView<const std::uint8_t> missing;      ///< As in the scene.
  image::OctantImage edge_distance_third_px;  ///< Chamfer distance per falling direction.
  ImageView<float> normal_x;
  ImageView<float> normal_y;
};

/// The distances that the refinement reads in one direction: those of FineImages, bounded.
struct BoundedDistance {
  image::OctantChannel distance_third_px;
  int width_px = 0;
  int height_px = 0;

  BoundedDistance(const FineImages& images, int octant) noexcept
      : distance_third_px(images.edge_distance_third_px[octant]),
        width_px(images.grid.width_px),
        height_px(images.grid.height_px) {}
  std::uint8_t operator()(int x, int y) const noexcept {
    return std::min(distance_third_px(x, y), kEdgeDistanceMax_third_px);
  }
};

[[nodiscard]] FineImages take_fine_images(Arena& arena, const rectify::Grid& grid) noexcept;

/// Fills the images from the scene.  Cost: four passes over the map.
[[nodiscard]] Status build_fine_images(const scene::Scene& scene, FineImages& images) noexcept;

/// build_fine_images() in parts: what is the scene's own; the distances; normals are those of
/// image::write_normals().
[[nodiscard]] Status begin_fine_images(const scene::Scene& scene, FineImages& images) noexcept;
[[nodiscard]] Status write_fine_distances(const scene::Scene& scene, FineImages& images,
                                          const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::refine
