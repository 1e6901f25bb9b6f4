#pragma once
// The grid search over x, y and phi (Ingberg 2015, 2.10): every planar cell of the coarse level is
// a place for the anchor, every angle of the part's symmetry sector a hypothesis there.

#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/result.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/search/score.hpp"
#include "flatpose/search/search_images.hpp"
#include "flatpose/search/tilt_field.hpp"

namespace flatpose::search {

inline constexpr int kAngleCountMax = 720;

struct GridSearchConfig {
  ScoreConfig score;
  int stride_px =
      1;  ///< Only every so many-th cell is a place, >= 1; the refinement comes home from further.
  double angle_step_rad = 0.12;  ///< > 0; finer costs time in proportion.
  double max_tilt_rad = 0.8;     ///< Steeper places are no hypotheses; 0..1.57.
  double planarity_mm = 0.5;  ///< Places whose plane fit leaves more than this are no hypotheses.
  double cost_share_max =
      0.6;  ///< Hypotheses dearer than this share of the worst are no candidates; 0..1.
};

/// One hypothesis worth a closer look.
struct Candidate {
  std::int32_t cost_q10 = 0;  ///< Cost as a share of the worst at its own tilt, times 1024. The
                              ///< list is in order of the plain cost.
  std::int32_t angle_index = 0;
  std::int16_t column = 0;
  std::int16_t row = 0;
  std::int16_t anchor = 0;
  Pose work_T_object;
};

struct GridSearchResult {
  int candidate_count = 0;            ///< Filled in `candidates`, best first.
  std::int64_t hypothesis_count = 0;  ///< Left by the planarity gate.
};

/// Takes (and leaves taken) the scratch of every stage of the search on a map of half of `fine`'s
/// resolution, also from a measuring arena.
void reserve_search_scratch(Arena& arena, const rectify::Grid& fine) noexcept;

/// Finds the best hypotheses that differ in place or angle.
/// Shape: `field` fits `images.grid`.  Cost: places x angles x points, ended early against the best
/// so far. Memory: `scratch` takes about 70 bytes a cell.  Fails: kOutOfMemory, kShapeMismatch,
/// kInvalidArgument (anchor_index; a config field out of its range).
/// Ties: by row, column, angle.  Thread: reentrant.
[[nodiscard]] Result<GridSearchResult> grid_search(const SearchImages& images,
                                                   const TiltField& field,
                                                   const model::Template& part, int anchor_index,
                                                   const GridSearchConfig& config, Arena& scratch,
                                                   std::span<Candidate> candidates) noexcept;

/// The angles that the part's symmetry leaves to search.
[[nodiscard]] int angle_count(const model::Symmetry& symmetry, double angle_step_rad) noexcept;
/// The size of the sector that they share evenly.
[[nodiscard]] double angle_range_rad(const model::Symmetry& symmetry) noexcept;

}  // namespace flatpose::search
