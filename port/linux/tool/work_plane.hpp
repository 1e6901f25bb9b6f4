#pragma once
// The plane that parts lie on: of all planes in a scan the one that carries most points and has
// next to nothing below it.
//
// RANSAC of a fixed seed (Fischler and Bolles 1981) over a bounded sample finds it, least squares
// with Tukey's weights over the sample settle it. The same scan gives the same plane.

#include <array>
#include <cstdint>
#include <optional>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/result.hpp"
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
  std::array<Vec3, 4> corner_scan_mm{};  ///< Of the plane, where the box around all points ends.
};

/// What find_work_plane() takes of an arena for a scan of so many pixels.
[[nodiscard]] std::size_t work_plane_bytes(std::size_t pixel_count) noexcept;

/// Units/frames: `up_sign` is +1 or -1, the scan's side to the sensor; noise and pitch in mm.
/// Cost: tens of milliseconds; looks at the budget every few hundred microseconds, but for the last
/// pass over the scan.  Fails: kTooFewPoints (no plane within 60 degrees of up carries enough of
/// them), kOutOfMemory, kStopped.
[[nodiscard]] Result<WorkPlane> find_work_plane(const RangeImageView& scan, int up_sign,
                                                double noise_mm, double pitch_mm, Arena& arena,
                                                const Budget& budget) noexcept;

/// The same in memory of its own; none when there is no plane.
[[nodiscard]] std::optional<WorkPlane> find_work_plane(const RangeImageView& scan, int up_sign,
                                                       double noise_mm, double pitch_mm);

/// How a plane lies against where it was: along its normal and in tilt. What moves within the plane
/// itself does not show.
struct PlaneShift {
  double middle_mm = 0.0;    ///< Under the scan's middle, upward.
  double tilt_rad = 0.0;     ///< Between the normals.
  double greatest_mm = 0.0;  ///< Anywhere in the scan, up or down.

  [[nodiscard]] bool is_within(double shift_mm, double tilt_max_rad) const noexcept {
    return greatest_mm <= shift_mm && tilt_rad <= tilt_max_rad;
  }
};
/// Usual tolerances.
inline constexpr double kShiftMax_mm = 1.0;
inline constexpr double kTiltMax_deg = 0.5;

/// Of the plane found in a scan against an alignment from before.
[[nodiscard]] PlaneShift shift_of(const WorkPlane& found, const Pose& work_T_scan) noexcept;

}  // namespace flatpose::tool
