#pragma once
// All memory of one search, laid out in one place, so that measuring and taking it cannot disagree.

#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/locate/instances.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/refine/fine_images.hpp"
#include "flatpose/refine/polish.hpp"
#include "flatpose/scene/scene.hpp"
#include "flatpose/search/grid_search.hpp"
#include "flatpose/search/places.hpp"
#include "flatpose/search/search_images.hpp"
#include "flatpose/search/tilt_field.hpp"

namespace flatpose::locate {

inline constexpr int kCandidateCountMax = 192;  ///< Of one anchor.
inline constexpr int kInstanceCountMax = 2 * kCandidateCountMax;
inline constexpr int kStartCountMax = 4 * kCandidateCountMax;

struct Workspace {
  refine::FineImages fine;
  search::SearchImages coarse;
  search::TiltField tilt;
  search::Places places;
  ImageView<std::uint8_t> claimed;
  std::span<search::Candidate> candidates;
  std::span<Instance> instances;
  std::span<Pose> starts;  ///< Of refinements.
  refine::PolishScratch polish;
};

/// Takes everything but the scene, which build_scene takes itself.
[[nodiscard]] Workspace take_workspace(Arena& arena, const rectify::Grid& grid) noexcept;

/// Longest side of a height map.
inline constexpr int kMapSideMax_px = 4096;

/// Bytes for any scan and field within the limits, scratch included.
[[nodiscard]] std::size_t workspace_required_bytes(const Limits& limits) noexcept;

}  // namespace flatpose::locate
