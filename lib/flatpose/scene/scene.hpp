#pragma once
// A scan as teach and locate see it: rectified to the finest level, filled, with its edges.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/image/edge.hpp"
#include "flatpose/rectify/height_map.hpp"
#include "flatpose/rectify/rectify.hpp"

namespace flatpose::scene {

/// Contours are thin: a map with more edge cells than one in so many is noise.
inline constexpr std::size_t kCellsPerEdge = 4;

struct SceneConfig {
  double noise_mm = 0.1;  ///< Standard deviation of a height, > 0; edges must rise above it.
  double pitch_mm = 1.0;  ///< Distance of neighbouring points of the scan, > 0.
  double step_mm = 0.0;   ///< Steps that matter, when known (0: all that stand out of the noise).
  rectify::Method method = rectify::Method::kPaint;
  VectorPath vector_path = VectorPath::kPortable;  ///< One that the processor has.
  const rectify::ScanReach* reach = nullptr;       ///< From the scan's survey: see PaintConfig.
};

struct Scene {
  rectify::HeightMap map;
  ImageView<float> filled_mm;
  ImageView<std::uint8_t> missing;    ///< 0: seen, 1: filled, image::kDarkPit: filled and lowered.
  ImageView<std::uint8_t> edge_kind;  ///< image::EdgeKind
  std::span<const image::EdgePoint> edges;  ///< Jumps and borders of missing data.
  double noise_mm = 0.0;
  double pitch_mm = 0.0;
  VectorPath vector_path = VectorPath::kPortable;  ///< For what is made of the scene.
};

/// The smallest step of height that counts as a contour.
[[nodiscard]] double edge_threshold_mm(const SceneConfig& config) noexcept;

/// Takes the images of a scene from `arena` (also from a measuring one).
[[nodiscard]] Scene take_scene(Arena& arena, const rectify::Grid& grid,
                               std::span<image::EdgePoint>& edge_memory) noexcept;

/// Rectifies, fills and finds the edges.
/// Memory: `arena` keeps what take_scene takes; scratch on top of it is given back.
/// Fails: as rectify and detect_edges; kTooLarge when the scan has more edge cells than a quarter
/// of its cells.  Thread: reentrant; shared out over `budget`.
[[nodiscard]] Status build_scene(const RangeImageView& scan, const Frames& frames,
                                 const rectify::Grid& grid, const SceneConfig& config, Arena& arena,
                                 Scene& scene, const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::scene
