#pragma once
// What `flatpose align` may be asked for, and the three things it does.

#include <string>

#include "port/linux/tool/command.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/work_plane.hpp"

namespace flatpose::tool {

struct AlignOptions {
  std::string scan_path;
  std::string output_path;
  std::string touch_path;   ///< The pairs; empty: no --touch.
  std::string verify_path;  ///< The work plane to verify; empty: none.
  double rms_max_mm = 3.0;
  double shift_max_mm = kShiftMax_mm;
  double tilt_max_deg = kTiltMax_deg;
  ScanOptions reading;  ///< With --touch its work plane says what frame the scan's points are in.
};

/// The work plane of a scan.
[[nodiscard]] ExitCode align_plane(const AlignOptions& options, Report& report);
/// The robot's frame from touched points.
[[nodiscard]] ExitCode align_touch(const AlignOptions& options, Report& report);
/// Whether a work plane still lies where it did; kNone: it does not.
[[nodiscard]] ExitCode align_verify(const AlignOptions& options, Report& report);

/// The plane that a scan shows.  Fails: NothingFound.
[[nodiscard]] WorkPlane plane_of(const LoadedScan& loaded);

}  // namespace flatpose::tool
