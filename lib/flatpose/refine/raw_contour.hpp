#pragma once
// Where the part's surface really ends, measured on the scan's own rows and columns: from inside
// the contour a scan line is followed outward to the last point that still lies on the surface. The
// contour lies half a step beyond it, the same in teach and locate, so that what is systematic
// cancels.

#include "flatpose/model/template.hpp"
#include "flatpose/refine/raw_scan.hpp"

namespace flatpose::refine {

struct RawContourConfig {
  double search_mm = 2.0;  ///< A contour farther than this from where it is expected is not taken.
  double tolerance_mm = 1.0;  ///< A point no higher than this above the surface lies on it.
};

struct Crossing {
  bool found = false;
  double offset_mm = 0.0;  ///< Along the contour's outward normal: measured minus expected.
  double width_mm = 0.0;   ///< Over which the height falls, beyond one step of the scan: 0 at a
                           ///< sharp edge; where a ramp ends depends on how the sensor looks at it.
};

/// Measures one contour point.  Cost: one scan line over at most a few dozen points.  Thread:
/// reentrant.
[[nodiscard]] Crossing measure_crossing(const RawScan& raw, const Pose& work_T_object,
                                        const model::ContourPoint& point,
                                        const RawContourConfig& config) noexcept;

}  // namespace flatpose::refine
