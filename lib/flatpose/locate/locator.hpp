#pragma once
// The pipeline: a range image and a template in, verified poses out (Ingberg 2015, figure 3.3, and
// beyond).
//
//   scan -> rectify, fill, edges -> coarse grid search -> Levenberg-Marquardt -> raw points ->
//   verification -> matches
//
// All memory is the caller's: required_bytes(limits), then init(limits, memory). After that nothing
// allocates.

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/host.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/geometry/region.hpp"
#include "flatpose/locate/outcome.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/rectify/rectify.hpp"

namespace flatpose::locate {

inline constexpr int kMatchCountMax = 64;
inline constexpr int kExclusionCountMax = 16;

/// What the memory must suffice for.
struct Limits {
  int scan_width_px = 1536;
  int scan_height_px = 1280;
  int cell_count = 4'000'000;  ///< Cells of the finest height map: field area over cell area.
  VectorPath vector_path = VectorPath::kPortable;  ///< One that the processor has.
};

enum class Order { kScore, kHeight, kVisible };

struct LocateConfig {
  int max_matches = 1;        ///< 1..kMatchCountMax.
  double min_score = -1.0;    ///< 0..1; negative: the part's own threshold.
  double min_visible = 0.5;   ///< Share of the surface that must be visible, 0..1.
  double max_tilt_rad = 0.8;  ///< Against the work plane, 0..1.2.
  Order order = Order::kScore;
  Region region;         ///< Where the part's origin may lie, in the frame at the face.
  /// Where it may not lie, up to kExclusionCountMax. The caller's, for as long as a search lasts.
  std::span<const Region> exclusions{};
  /// The range of the origin's z, in the frame at the face. What lies outside of it, or inside an
  /// exclusion, is not searched any further and takes no place among the matches.
  double height_min_mm = -std::numeric_limits<double>::infinity();
  double height_max_mm = std::numeric_limits<double>::infinity();
  double cell_mm = 0.0;  ///< Finest level; 0: the template's. Smaller is slower and finer.
  rectify::Method method = rectify::Method::kPaint;
  bool use_height = true;  ///< Off, with the next: the search as the thesis has it.
  bool use_directions = true;
  std::int64_t deadline_us = 0;  ///< After the call; 0: none.
};

struct Match {
  Pose face_T_object;
  double score = 0.0;
  double visible = 0.0;
  Vec3 sigma_mm;              ///< Standard deviation of the position along the face's axes. What
                              ///< teach measured amiss, alike in every scan, is not in it.
  Vec3 sigma_rad;             ///< Of the turn about the object's own axes.
  bool turn_is_free = false;  ///< Full symmetry: sigma_rad.z means nothing.
  double edge_rms_mm = 0.0;
  double surface_rms_mm = 0.0;
  /// Of (turn, shift) in the object's own axes, rad and mm, the upper triangle by rows: what
  /// sigma.hpp tells other points' sigma from.
  std::array<float, 21> covariance{};
};

struct Timings {
  std::int64_t rectify_us = 0;
  std::int64_t features_us = 0;
  std::int64_t search_us = 0;
  std::int64_t refine_us = 0;
  std::int64_t verify_us = 0;
  std::int64_t total_us = 0;
};

struct LocateResult {
  Outcome outcome = Outcome::kNoMatch;
  int match_count = 0;
  std::array<Match, kMatchCountMax> matches{};
  Timings timings;
  /// Places times angles that the planarity gate left, of the anchors searched: further ones are
  /// only while fewer parts than asked for are beyond doubt.
  std::int64_t hypothesis_count = 0;
  /// Of these, the ones looked at one by one: for the others a bound was enough.
  std::int64_t evaluated_count = 0;
  /// Whether all of these and all candidates were gone through: no deadline struck.
  bool is_exact = true;
  /// By how much of a score what was not gone through could be better than the best match.
  double bound_gap = 0.0;
  std::int64_t candidate_count = 0;
  std::size_t peak_bytes = 0;
  double rival_score = 0.0;  ///< The best score of another pose in the place of a match.
  double best_rejected_score =
      0.0;  ///< The best that did not become a match: how near a miss or a rival came.

  [[nodiscard]] std::span<const Match> found() const noexcept {
    return {matches.data(), static_cast<std::size_t>(match_count)};
  }
};

/// FNV-1a 64 over outcome, count, and each match's score, visible, position, rotation and sigma.
[[nodiscard]] std::uint64_t digest(const LocateResult& result) noexcept;

[[nodiscard]] Status validate(const LocateConfig& config) noexcept;

class Locator {
 public:
  [[nodiscard]] static std::size_t required_bytes(const Limits& limits) noexcept;

  /// Takes the memory. It must outlive the locator.  Fails: kOutOfMemory, kInvalidArgument.
  [[nodiscard]] Status init(const Limits& limits, std::span<std::byte> memory) noexcept;

  /// Finds the part in a scan. What a search may end with (no match, empty scene) is
  /// `result.outcome`. Units/frames: poses are face_T_object.  Cost: milliseconds to tens of them,
  /// see the README.  Memory: as given. Fails: kInvalidArgument (config or template), kTooLarge
  /// (scan or field beyond the limits), kNotFinite (an infinite or giant coordinate).  Thread: one
  /// at a time per locator.
  [[nodiscard]] Status locate(const model::Template& part, const RangeImageView& scan,
                              const Frames& frames, const LocateConfig& config, const Host& host,
                              LocateResult& result) noexcept;

 private:
  Limits limits_;
  Arena arena_;
};

}  // namespace flatpose::locate
