#pragma once
// What the search reads: the coarse level as small integers, so that a score is an exact sum that
// no order, thread or vector width can change.

#include <array>
#include <cstdint>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/image/edge.hpp"
#include "flatpose/rectify/height_map.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::search {

inline constexpr int kHeightUnitsPerMm = 16;
/// 2 m from the middle; beyond it heights saturate.
inline constexpr double kHeightUnitMax = 32767.0;
inline constexpr int kNormalUnits = 127;  ///< A component of 1.
inline constexpr std::uint8_t kEdgeCostMax =
    15;  ///< Thirds of a coarse cell: beyond five cells an edge is no evidence.

struct SearchImages {
  rectify::Grid grid;
  ImageView<float> filled_mm;  ///< The height map halved, missing cells filled.
  ImageView<std::uint8_t> missing;
  std::array<ImageView<std::uint8_t>, image::kOctantCount>
      edge_cost;  ///< Chamfer distance per falling direction, 0..kEdgeCostMax.
  ImageView<std::int16_t> height_unit;  ///< Filled height above base_mm.
  ImageView<std::int8_t> normal_x_unit;
  ImageView<std::int8_t> normal_y_unit;
  double base_mm = 0.0;
};

/// Takes the images of the coarse level, of half the resolution of `fine`.
[[nodiscard]] SearchImages take_search_images(Arena& arena, const rectify::Grid& fine) noexcept;

/// Fills the images from the scene; heights more than `jump_mm` apart are not averaged.
/// Fails: kOutOfMemory (scratch), kTooFewPoints (nothing valid).
[[nodiscard]] Status build_search_images(const scene::Scene& scene, double jump_mm, Arena& scratch,
                                         SearchImages& images) noexcept;

}  // namespace flatpose::search
