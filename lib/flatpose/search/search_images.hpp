#pragma once
// What the search reads: the coarse level as bytes, so that a score is an exact sum that no order,
// thread or vector width can change, and a block of places is one load.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/image_view.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/image/edge.hpp"
#include "flatpose/rectify/height_map.hpp"
#include "flatpose/scene/scene.hpp"
#include "flatpose/search/lattice.hpp"
#include "flatpose/search/node_images.hpp"

namespace flatpose::search {

/// Thirds of a coarse cell: beyond five cells an edge is no evidence.
inline constexpr std::uint8_t kEdgeCostMax = 15;
inline constexpr std::uint8_t kEdgeCostUnknown = 8;  ///< Half: what says nothing.
inline constexpr int kSurfaceCostMax = 10;           ///< Steps of a tolerance.
inline constexpr int kHeightUnitMax = 240;           ///< Heights saturate at 0 and here.
inline constexpr std::uint8_t kOutsideUnit = 255;    ///< Higher than anything: hides what is there.
inline constexpr int kNormalZero = 127;              ///< A component of 0.

struct SearchImagesConfig {
  int stride_px = 1;                   ///< A place every so many cells, 1..kStrideMax_px.
  int reach_px = kReachMax_px;         ///< How far template points lie from the anchor, at most.
  double height_tolerance_mm = 3.0;    ///< Where the height cost reaches its maximum; > 0.
  double normal_tolerance_rad = 0.35;  ///< Where the normal cost reaches its maximum; > 0.
  bool use_height = true;              ///< Off: normals instead, as the thesis has it.
  bool use_directions = true;          ///< Off: any edge serves, whichever way it falls.
  int node_side = 0;                   ///< Places across a node of branch and bound: 2, 4; 0: none.
  int node_slack = 0;  ///< Places by which offsets of a node's angles may differ; more than 0 pays
                       ///< where neighbouring angles move no point by a place. Stride 1 only.
};

struct HeightRange {
  double low_mm = 0.0;
  double high_mm = 0.0;
};

struct SearchImages {
  static constexpr int kSurfaceImage = image::kOctantCount;  ///< Heights, or normals' x, then y.
  static constexpr int kImageCountMax = image::kOctantCount + 2;

  rectify::Grid grid;          ///< Of the cells.
  ImageView<float> filled_mm;  ///< The height map halved, missing cells filled.
  SearchImagesConfig config;
  Lattice lattice;
  std::span<std::uint8_t> bytes;  ///< The images one after the other, each in its phases.
  NodeImages nodes;
  double base_mm = 0.0;  ///< Height of unit 0.
  double height_unit_mm = 1.0;
  std::int32_t surface_cap = kSurfaceCostMax;  ///< Units at which the surface cost saturates.
  std::int32_t surface_weight = 1;             ///< Cost of one unit.

  /// The byte of a cell, which may lie up to the lattice's reach outside the field.
  [[nodiscard]] std::int32_t at(int image_index, int x, int y) const noexcept {
    const auto first = static_cast<std::ptrdiff_t>(image_index) *
                       static_cast<std::ptrdiff_t>(lattice.image_bytes());
    return *(bytes.data() + first + lattice.byte_of(0, 0) + lattice.offset_bytes(x, y));
  }
  [[nodiscard]] std::int32_t edge_cost(int octant, int x, int y) const noexcept {
    return at(config.use_directions ? octant : 0, x, y);
  }
  [[nodiscard]] std::int32_t height_unit(int x, int y) const noexcept {
    return at(kSurfaceImage, x, y);
  }
  [[nodiscard]] std::int32_t normal_x_unit(int x, int y) const noexcept {
    return at(kSurfaceImage, x, y);
  }
  [[nodiscard]] std::int32_t normal_y_unit(int x, int y) const noexcept {
    return at(kSurfaceImage + 1, x, y);
  }
};

/// A component of a unit normal as the images hold it.
[[nodiscard]] std::int16_t normal_unit(double component, const SearchImagesConfig& config) noexcept;
/// A height as the images hold it.
[[nodiscard]] std::uint8_t height_unit(double height_mm, const SearchImages& images) noexcept;

/// Takes the memory of the coarse level, of half the resolution of `fine`, for any config; one with
/// nodes asks for as much again.
[[nodiscard]] SearchImages take_search_images(Arena& arena, const rectify::Grid& fine,
                                              bool with_nodes = false) noexcept;

/// Takes (and leaves taken) the scratch of write_edge_costs() alone, of halve_heights() and
/// write_surface(), and of any of the calls below, on the coarse level, also from a measuring
/// arena.
void reserve_edge_cost_scratch(Arena& arena, const rectify::Grid& coarse) noexcept;
void reserve_surface_scratch(Arena& arena, const rectify::Grid& coarse) noexcept;
void reserve_image_scratch(Arena& arena, const rectify::Grid& coarse) noexcept;

/// Halves the scene's heights; heights more than `jump_mm` apart are not averaged.
/// Fails: kOutOfMemory (scratch), kTooFewPoints (nothing valid).
[[nodiscard]] Status halve_heights(const scene::Scene& scene, double jump_mm, Arena& scratch,
                                   SearchImages& images) noexcept;

/// Fills the bytes. `range` is where places lie: heights beyond it by more than the tolerance are
/// told apart no further.
/// Fails: kOutOfMemory (scratch), kInvalidArgument (config; nodes
/// without memory; edges that do not go by rows).
[[nodiscard]] Status build_search_images(const scene::Scene& scene,
                                         const SearchImagesConfig& config, const HeightRange& range,
                                         Arena& scratch, SearchImages& images) noexcept;

/// build_search_images() in parts: first begin_search_images(), then the two others, which touch
/// nothing of each other's, at last build_node_images().
[[nodiscard]] Status begin_search_images(const SearchImagesConfig& config,
                                         SearchImages& images) noexcept;
[[nodiscard]] Status write_surface(const HeightRange& range, Arena& scratch,
                                   SearchImages& images) noexcept;
[[nodiscard]] Status write_edge_costs(const scene::Scene& scene, Arena& scratch,
                                      const SearchImages& images,
                                      const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::search
