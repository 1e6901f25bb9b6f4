#pragma once
// What must be known of a scan before it is rectified: how much is there, where it lies, how dense
// and how noisy it is; and the grid that follows from it.
//
// One pass over all points gives count and bounding box. Pitch and noise are medians over a bounded
// sample spread evenly over the scan, so neither jumps nor flying points move them. The noise comes
// from second differences |z(i-1) - 2 z(i) + z(i+1)|, which no plane disturbs: their lower half has
// the mean 0.3246 * sqrt(6) sigma when the noise is normal. (The mean of the half, for sensors that
// count heights in steps would put a median onto a step.) Along rows and along columns, and the
// larger counts: sensors smooth along the laser line, and noise that neighbours share is not seen.

#include <cstddef>
#include <limits>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/result.hpp"
#include "flatpose/core/vector_path.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/height_map.hpp"
#include "flatpose/rectify/scan_reach.hpp"

namespace flatpose::rectify {

struct Survey {
  int point_count = 0;  ///< Pixels of the scan.
  int valid_count = 0;
  double missing_share = 1.0;  ///< [0, 1]
  Vec3 min_mm;                 ///< Bounding box in the work frame; zero without valid points.
  Vec3 max_mm;
  double pitch_along_row_mm = 0.0;     ///< Distance in x and y from a pixel to the next column's,
                                       ///< median; 0 when no two neighbours are valid.
  double pitch_along_column_mm = 0.0;  ///< The same to the next row's.
  double noise_sigma_mm = 0.0;         ///< Of a point's z in the work frame; 0 when unknown.
  ScanReach reach;                     ///< For painting.
};

/// Bytes of scratch that survey() takes, whatever the scan.
[[nodiscard]] std::size_t survey_required_bytes() noexcept;

/// Surveys `scan` in the work frame. A scan of missing points alone is surveyed, not refused.
/// Cost: one pass, and a bounded sample.  Memory: survey_required_bytes() of scratch, given back.
/// Fails: kNotFinite (an infinite coordinate, or one beyond 1e6 mm; NaN is a missing point),
/// kInvalidArgument, kTooLarge, kOutOfMemory.  Thread: reentrant; rows are shared out over
/// `budget`.
[[nodiscard]] Result<Survey> survey(const RangeImageView& scan, const Pose& work_T_scan,
                                    Arena& scratch, VectorPath path = VectorPath::kPortable,
                                    const Budget& budget = callers_thread) noexcept;

/// A box in x and y of the work frame; without bounds as it stands.
struct Region {
  double x_min_mm = -std::numeric_limits<double>::infinity();
  double y_min_mm = -std::numeric_limits<double>::infinity();
  double x_max_mm = std::numeric_limits<double>::infinity();
  double y_max_mm = std::numeric_limits<double>::infinity();
};

struct GridConfig {
  double cell_mm = 1.0;          ///< (0, 1e6]. Half of it costs four times as much everywhere.
  Region region{};               ///< Nothing outside is looked at.
  double margin_mm = 0.0;        ///< Added on every side, [0, 1e6].
  int cells_max = 16 * 1 << 20;  ///< Bounds the memory of all that follows.
};

/// The grid over what a survey found within the region. Borders of cells lie on multiples of
/// cell_mm, so a point more or less does not shift the lattice by a fraction of a cell.
/// Fails: kInvalidArgument, kTooFewPoints (no valid point, or the region misses their box),
/// kTooLarge (over cells_max, or a side over 32767 cells).
[[nodiscard]] Result<Grid> choose_grid(const Survey& survey, const GridConfig& config) noexcept;

}  // namespace flatpose::rectify
