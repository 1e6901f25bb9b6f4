// flatpose align SCAN --verify WORK.json

#include "flatpose/core/maths.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/work_file.hpp"
#include "port/linux/tool/align_options.hpp"

namespace flatpose::tool {

ExitCode align_verify(const AlignOptions& options, Report& report) {
  const port::WorkFile work = port::read_work_file(options.verify_path);
  ScanOptions reading = options.reading;
  if (reading.up && *reading.up != work.up)
    throw port::InputError("--up", options.verify_path + " was aligned with the other side up",
                           "leave --up out or align again with it");
  reading.up = work.up;
  const LoadedScan loaded = load_scan(options.scan_path, reading);
  require_points(loaded);
  const PlaneShift shift = shift_of(plane_of(loaded), work.work_T_scan);
  const bool holds = shift.is_within(options.shift_max_mm, options.tilt_max_deg * kRadPerDeg);
  report.text = formatted(
      "%s %s in %s\n  moved %+.3f mm under the scan's middle, %.3f mm at most anywhere (%.3f "
      "allowed), tilted %.3f deg (%.3f allowed)\n",
      options.verify_path.c_str(), holds ? "holds" : "does not hold", loaded.path.c_str(),
      shift.middle_mm, shift.greatest_mm, options.shift_max_mm, shift.tilt_rad * kDegPerRad,
      options.tilt_max_deg);
  return holds ? ExitCode::kDone : ExitCode::kNone;
}

}  // namespace flatpose::tool
