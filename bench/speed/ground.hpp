#pragma once
// What the two grid searches read of one simulated scan: a lattice of as many places a side as a
// row of Ingberg 2015, table 4.1, has, every place a hypothesis at every angle.
//
// The thesis tests every position; ours as a rule only planar ones. So that both test the same
// hypotheses the gate is held open: where no plane fits, the place keeps the tilt that was read
// there, the steepest allowed at most; on the border, where there is no window, that of its
// neighbour further in. Gated, both leave out the same places.

#include <memory>
#include <string>

#include "bench/scenes/trial.hpp"
#include "bench/speed/thesis_search.hpp"
#include "flatpose/search/grid_search.hpp"

namespace flatpose::bench {

struct GroundConfig {
  std::string scene = "lone";
  std::string part = "pad";
  std::uint64_t seed = 0;
  int places_per_side = 240;   ///< At 2 mm, cut out of the middle of the field; beyond the field
                               ///< the scene is repeated.
  int angle_count = 240;       ///< Of a part without symmetry.
  int point_count = 14;        ///< Half of them contour, half surface.
  bool is_gated = false;       ///< Only planar places are hypotheses, as in locate.
  bool is_level = false;       ///< All places have one tilt: the block loop at its best.
  bool use_height = true;      ///< Off: normals in place of heights, as the thesis.
  bool use_directions = true;  ///< Off: edges in one image, as the thesis.
  int node_side = 0;           ///< As search::SearchImagesConfig has it.
  int node_slack = 0;
  double first_share = 0.0;  ///< As search::GridSearchConfig has it; 0: its default.
};

/// All that grid_search() asks for. Neither moved nor copied: views point into it.
struct Ground {
  GroundConfig config;
  const model::Template* part = nullptr;
  std::vector<tool::Memory> memory;
  Arena scratch;
  /// The field itself, before it is repeated: what the thesis's images are made of.
  int field_px = 0;
  ImageView<float> chamfer_px;
  ImageView<float> normal_x;
  ImageView<float> normal_y;

  search::SearchImages images;
  search::TiltField field;
  search::Places places;
  search::GridSearchConfig search;

  [[nodiscard]] int angle_count() const;
  [[nodiscard]] std::int64_t hypothesis_count() const;
  /// Hypotheses x points.
  [[nodiscard]] double evaluation_count() const;
};

/// `part` must outlive it.  Fails: std::runtime_error.
[[nodiscard]] std::unique_ptr<Ground> make_ground(const GroundConfig& config,
                                                  const model::Template& part);

/// What the thesis's search reads of the same places.
struct ThesisGround {
  thesis::Images images;
  thesis::Cloud cloud;
  std::vector<thesis::Tilt> tilts;  ///< By bin of slopes; those that occur are filled.
};
[[nodiscard]] ThesisGround make_thesis_ground(const Ground& ground);

}  // namespace flatpose::bench
