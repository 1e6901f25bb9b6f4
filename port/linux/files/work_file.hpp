#pragma once
// WORK.json: where the work plane lies in the scan's frame, as `align` found it. With it everything
// in and out is in the frame `work` (z up off the plane):
// {"format":"flatpose-work","version":1,"up":"-z",
//  "work_T_scan":{"position_mm":[3],"rotation":[9 numbers, row by row]},
//  "quality":{"plane_rms_mm":..,"inlier_share":..,"inlier_count":..}}

#include <cstdint>
#include <optional>
#include <string>

#include "flatpose/geometry/pose.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {

/// How well the plane was seen.
struct WorkQuality {
  double plane_rms_mm = 0.0;  ///< Of the points taken as the plane's.
  double inlier_share = 0.0;  ///< Of all valid points, 0 to 1.
  std::int64_t inlier_count = 0;
};

struct WorkFile {
  Pose work_T_scan;
  Up up = Up::kMinusZ;  ///< The side of the scan that was taken as up.
  std::optional<WorkQuality> quality;
};

/// Fails: InputError; a rotation must be one within 1e-6.
[[nodiscard]] WorkFile read_work_file(const std::string& path);
/// Numbers are written so that they read back the same.  Fails: InputError; nothing is left then.
void write_work_file(const std::string& path, const WorkFile& work);

}  // namespace flatpose::port
