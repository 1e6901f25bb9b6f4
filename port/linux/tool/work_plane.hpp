#pragma once
// The plane that parts lie on: of all planes in a scan the one that carries most points and has
// next to nothing below it.
//
// RANSAC of a fixed seed (Fischler and Bolles 1981) over a bounded sample finds it, least squares
// with Tukey's weights over the sample settle it. The same scan gives the same plane.

#include <cstdint>
#include <optional>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"

namespace flatpose::tool {

struct WorkPlane {
  Pose work_T_scan;  ///< Origin on the plane under the scan's middle, z toward the sensor, x as
                     ///< the scan's x laid onto the plane.
  double tilt_rad = 0.0;      ///< Of the plane's normal against the scan's up.
  double rms_mm = 0.0;        ///< Of the plane's points about it.
  double inlier_share = 0.0;  ///< Of all valid points.
  std::int64_t inlier_count = 0;
};

/// None when too few points lie on any one plane within 60 degrees of up.
/// Units/frames: `up_sign` is +1 or -1, the scan's side to the sensor; noise and pitch in mm.
[[nodiscard]] std::optional<WorkPlane> find_work_plane(const RangeImageView& scan, int up_sign,
                                                       double noise_mm, double pitch_mm);

}  // namespace flatpose::tool
