#pragma once
// What the refinement reads: the finest level as continuous images (Ingberg 2015, 2.7, 2.11).

#include <array>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/image/direction_channels.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::refine {

inline constexpr std::uint8_t kEdgeDistanceMax_third_px =
    60;  ///< Beyond 20 cells a nearer edge is another part's.

struct FineImages {
  rectify::Grid grid;
  ImageView<const float> height_mm;  ///< NaN where missing.
  ImageView<const float> filled_mm;
  image::OctantImages edge_distance_third_px;  ///< Chamfer distance per falling direction.
  std::array<ImageView<float>, image::kOctantCount>
      edge_distance_spline;  ///< Its B-spline, in thirds of a cell.
  ImageView<float> normal_x;
  ImageView<float> normal_y;
};

[[nodiscard]] FineImages take_fine_images(Arena& arena, const rectify::Grid& grid) noexcept;

/// Takes (and leaves taken) the scratch of build_fine_images, also from a measuring arena.
void reserve_fine_scratch(Arena& arena, const rectify::Grid& grid) noexcept;

/// Fills the images from the scene.  Cost: nine passes over the map a direction.  Fails:
/// kOutOfMemory.
[[nodiscard]] Status build_fine_images(const scene::Scene& scene, Arena& scratch,
                                       FineImages& images) noexcept;

}  // namespace flatpose::refine
