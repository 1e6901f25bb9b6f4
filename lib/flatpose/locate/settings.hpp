#pragma once
// What every stage is told, derived from the part and the scan: the one place where tolerances come
// from.

#include "flatpose/locate/locator.hpp"
#include "flatpose/locate/verify.hpp"
#include "flatpose/refine/polish.hpp"
#include "flatpose/refine/pose_problem.hpp"
#include "flatpose/scene/scene.hpp"
#include "flatpose/search/grid_search.hpp"

namespace flatpose::locate {

/// What is this far below the threshold does not rise above it any more.
inline constexpr double kHopelessShare = 0.6;

struct Settings {
  scene::SceneConfig scene;
  search::PlaceConfig places;
  search::SearchImagesConfig search_images;
  search::GridSearchConfig search;
  search::OriginBounds origins;
  int tilt_radius_px = 3;  ///< Of the window that the tilt is read from, on the coarse level.
  refine::PoseProblemConfig wide;    ///< First refinement: from the grid's distance.
  refine::PoseProblemConfig narrow;  ///< Second: what is near already.
  refine::PolishConfig polish;
  VerifyConfig screen;  ///< A loose look at a candidate before it is refined.
  VerifyConfig near;    ///< A quick one after the first refinement.
  VerifyConfig verify;
  double score_threshold = 0.0;
};

/// `cell_mm` is the finest level's.
[[nodiscard]] Settings derive_settings(const model::Template& part, const LocateConfig& config,
                                       double noise_mm, double pitch_mm, double cell_mm) noexcept;

}  // namespace flatpose::locate
