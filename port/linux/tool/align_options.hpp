#pragma once
// What `flatpose align` may be asked for, and the three things it does.

#include <string>

#include "port/linux/tool/command.hpp"
#include "port/linux/tool/options.hpp"

namespace flatpose::tool {

struct AlignOptions {
  std::string scan_path;
  std::string output_path;
  std::string touch_path;   ///< The pairs; empty: no --touch.
  std::string verify_path;  ///< The work plane to verify; empty: none.
  double rms_max_mm = 3.0;
  ScanOptions reading;  ///< With --touch its work plane says what frame the scan's points are in.
};

/// The work plane of a scan.
[[nodiscard]] ExitCode align_plane(const AlignOptions& options, Report& report);
/// The robot's frame from touched points.
[[nodiscard]] ExitCode align_touch(const AlignOptions& options, Report& report);

}  // namespace flatpose::tool
