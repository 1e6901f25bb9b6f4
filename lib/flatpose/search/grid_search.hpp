#pragma once
// The grid search over x, y and phi (Ingberg 2015, 2.10): every planar place of the coarse level
// may carry an anchor, every angle of the part's symmetry sector is a hypothesis there.

#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/result.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/search/block_search.hpp"
#include "flatpose/search/candidate.hpp"
#include "flatpose/search/origin_bounds.hpp"
#include "flatpose/search/places.hpp"
#include "flatpose/search/score.hpp"
#include "flatpose/search/search_images.hpp"
#include "flatpose/search/tilt_field.hpp"

namespace flatpose::search {

struct GridSearchConfig {
  ScoreConfig score;
  double angle_step_rad = 0.12;  ///< > 0; finer costs time in proportion.
  /// Hypotheses dearer than this share of the worst are no candidates; 0..1.
  double cost_share_max = 0.6;
  /// A first round leaves out what costs more than this share of kCostMax. If the list of
  /// candidates comes out full the rest could not have entered it; else all is searched again. 1:
  /// one round. Measured: lists of 24 to 48 end at 0.6 to 0.72.
  double first_share = 0.72;
  VectorPath vector_path = VectorPath::kPortable;  ///< One that the processor has.
  const OriginBounds* origins = nullptr;  ///< Where the origin may not lie; null: anywhere.
  double origin_margin_mm = 0.0;          ///< What a candidate's origin may still be off by.
};

struct GridSearchResult {
  int candidate_count = 0;            ///< Filled in `candidates`, best first.
  std::int64_t hypothesis_count = 0;  ///< Left by the planarity gate.
  /// Of these, the ones that the last round looked at one by one: for the others a bound was
  /// enough.
  std::int64_t evaluated_count = 0;
};

/// Takes (and leaves taken) the scratch of every stage of the search on a map of half of `fine`'s
/// resolution, also from a measuring arena.
void reserve_search_scratch(Arena& arena, const rectify::Grid& fine,
                            bool with_nodes = false) noexcept;

/// Searches all places and angles, and fills `candidates` with the best that differ in place or
/// angle.
/// Cost: places x angles x points, ended early against the best so far.  Memory: `scratch` takes up
/// to 8 bytes a place and some for templates.  Fails: kOutOfMemory, kShapeMismatch (places of
/// another lattice), kInvalidArgument (anchor_index; a config field out of its range). Ties: by
/// row, column, angle.  Thread: reentrant; `budget` runs bands of rows side by side, and the
/// result is the same whoever does.
[[nodiscard]] Result<GridSearchResult> grid_search(const SearchImages& images,
                                                   const TiltField& field, const Places& places,
                                                   const model::Template& part, int anchor_index,
                                                   const GridSearchConfig& config, Arena& scratch,
                                                   std::span<Candidate> candidates,
                                                   const Budget& budget = callers_thread) noexcept;

/// The size of the sector of angles that the part's symmetry leaves to search. A part of full
/// symmetry has one angle, as long as the anchor is its centre.
[[nodiscard]] double angle_range_rad(const model::Symmetry& symmetry,
                                     const model::Anchor& anchor) noexcept;
/// The angles that share it evenly.
[[nodiscard]] int angle_count(double angle_range_rad, double angle_step_rad) noexcept;

}  // namespace flatpose::search
