#pragma once
// The robot's frame from touched points: the fit, what is left of each pair, how far off points are
// that were not fitted, and why a fit is none.

#include <string>
#include <vector>

#include "port/linux/files/robot_file.hpp"

namespace flatpose::tool {

inline constexpr std::size_t kTouchedPairsMin = 4;

struct TouchFit {
  Pose robot_T_scan;
  double rms_mm = 0.0;
  double worst_mm = 0.0;
  int worst_line = 0;  ///< Of the file of pairs.
  /// Root of the mean square over all pairs of the distance that a pair shows when it is left out.
  double leave_one_out_mm = 0.0;
  bool is_flat = false;  ///< All points in one plane: a mirrored frame would fit as well.
};

/// Writes each pair's residual too.
/// Fails: InputError naming `path` when there are fewer than four pairs, when they lie nearly on
/// one line, or when the distances of the two sides do not fit within `rms_max_mm`: with what is
/// likely wrong (units, mirrored columns, one bad pair).
[[nodiscard]] TouchFit fit_touched(const std::string& path, std::vector<port::TouchedPair>& pairs,
                                   double rms_max_mm);

}  // namespace flatpose::tool
