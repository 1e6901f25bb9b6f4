#pragma once
// The last step, on the scan's own points instead of the resampled map: every raw point inside the
// footprint and every place where a scan line leaves the surface, in one robust least squares over
// all six parameters. On a flat part the first tell z and tilt and the second x, y and phi; slopes
// and domes on the part help to hold x and y too.

#include <array>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/refine/footprint.hpp"
#include "flatpose/refine/levenberg_marquardt.hpp"
#include "flatpose/refine/raw_contour.hpp"
#include "flatpose/refine/raw_scan.hpp"

namespace flatpose::refine {

struct PolishConfig {
  double height_tolerance_mm =
      1.0;                 ///< Points farther off the surface than this are not the part's.
  double search_mm = 2.0;  ///< How far the contour may lie from where the first refinement left it.
  int round_count = 3;     ///< All but the last with a part of the points.
  VectorPath vector_path = VectorPath::kPortable;  ///< One that the processor has.
};

struct PolishResult {
  Pose work_T_object;
  std::array<double, 36> covariance{};  ///< Of (turn, shift) in the object's own axes; rad, mm.
  bool turn_is_free = false;            ///< Full symmetry: no turn about z was fitted.
  double edge_rms_mm = 0.0;
  double surface_rms_mm = 0.0;
  int crossing_count = 0;
};

/// A covariance of (turn, shift) in a pose's own axes, told in the axes of another frame on the
/// same body: with T = (R, s) the way from the first to the other, h_r' = R^T h_r and h_t' = R^T
/// (h_t + h_r x s).
[[nodiscard]] Matrix<6> covariance_seen_from(const Matrix<6>& covariance,
                                             const Pose& first_T_other) noexcept;

/// What was measured in a round.
struct PolishScratch {
  std::span<Crossing> crossings;  ///< By contour point.
  Footprint footprint;
};
[[nodiscard]] PolishScratch take_polish_scratch(Arena& arena) noexcept;

/// Fits the pose to the raw points.  Cost: a few hundred microseconds for 10 000 of them.
/// Fails: kTooFewPoints when the surface or the contour is hardly there.  Thread: reentrant, with a
/// scratch of its own.
[[nodiscard]] Result<PolishResult> polish(const model::Template& part, const RawScan& raw,
                                          const Pose& work_T_object, const PolishConfig& config,
                                          PolishScratch& scratch, const Budget& budget) noexcept;

}  // namespace flatpose::refine
