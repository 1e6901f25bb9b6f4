// flatpose align: SCAN -o WORK.json, SCAN --verify WORK.json, --touch PAIRS.csv -o ROBOT.json

#include <array>
#include <memory>

#include "flatpose/core/maths.hpp"
#include "port/linux/files/work_file.hpp"
#include "port/linux/tool/align_options.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/output_file.hpp"
#include "port/linux/tool/scan_survey.hpp"
#include "port/linux/tool/work_plane.hpp"

namespace flatpose::tool {
namespace {

// Less than this on the plane, and it may be no more than one part's top.
constexpr double kShareThin = 0.15;

}  // namespace

WorkPlane plane_of(const LoadedScan& loaded) {
  const rectify::Survey survey = survey_of(loaded);
  const double pitch_mm = std::max(survey.pitch_along_row_mm, survey.pitch_along_column_mm);
  const auto plane =
      find_work_plane(loaded.scan.view(), loaded.up_sign(), survey.noise_sigma_mm, pitch_mm);
  if (!plane)
    throw NothingFound(loaded.path, "no plane carries enough of its points",
                       "scan the empty work plane, or give the other side by --up");
  return *plane;
}

ExitCode align_plane(const AlignOptions& options, Report& report) {
  check_outputs(std::array{options.scan_path}, std::array{options.output_path});
  const LoadedScan loaded = load_scan(options.scan_path, options.reading);
  require_points(loaded);
  const WorkPlane plane = plane_of(loaded);
  port::WorkFile work;
  work.work_T_scan = plane.work_T_scan;
  work.up = loaded.scan.up;
  work.quality = port::WorkQuality{plane.rms_mm, plane.inlier_share, plane.inlier_count};
  port::write_work_file(options.output_path, work);
  if (plane.inlier_share < kShareThin)
    report.warnings.push_back(
        formatted("only %.0f %% of the points lie on the work plane: align with it empty",
                  100.0 * plane.inlier_share));
  const Vec3 origin_mm = plane.work_T_scan.inverse().position_mm;
  report.text = formatted(
      "work plane of %s (up %s by %s)\n  tilt %.3f deg, rms %.4f mm, %.1f %% of the points\n"
      "  origin at %.3f %.3f %.3f mm of the scan\n",
      loaded.path.c_str(), port::to_string(loaded.scan.up), loaded.scan.up_reason.c_str(),
      plane.tilt_rad * kDegPerRad, plane.rms_mm, 100.0 * plane.inlier_share, origin_mm.x,
      origin_mm.y, origin_mm.z);
  return ExitCode::kDone;
}

namespace {

[[noreturn]] void refuse(const char* option, const char* why, const char* remedy) {
  throw port::InputError(option, why, remedy);
}

ExitCode run(const AlignOptions& options, Report& report) {
  const bool by_touch = !options.touch_path.empty();
  const bool verifies = !options.verify_path.empty();
  if (verifies && (by_touch || !options.output_path.empty() || options.scan_path.empty()))
    refuse("--verify", "it goes with a SCAN alone", "flatpose align SCAN --verify WORK.json");
  if (by_touch && !options.scan_path.empty())
    refuse("--touch", "it needs no SCAN", "leave the scan out: the pairs say where its points are");
  if (!by_touch && options.scan_path.empty())
    refuse("align", "there is neither SCAN nor --touch", "name the scan of the work plane");
  if (!verifies && options.output_path.empty())
    refuse("--output", "it is not given", "say where the alignment goes: -o FILE.json");
  if (!by_touch && !options.reading.work_path.empty())
    refuse("--work", "it goes with --touch alone", "leave it out");
  if (verifies) return align_verify(options, report);
  return by_touch ? align_touch(options, report) : align_plane(options, report);
}

}  // namespace

Action add_align(CLI::App& app) {
  auto options = std::make_shared<AlignOptions>();
  app.add_option("SCAN", options->scan_path, "a scan that shows the work plane");
  app.add_option("-o,--output", options->output_path, "the work plane, or the robot's frame")
      ->type_name("FILE.json");
  add_text(app, "--touch", "PAIRS.csv",
           "points touched by the robot: scan_x,scan_y,scan_z,robot_x,robot_y,robot_z in mm, four "
           "lines at least; gives the robot's frame",
           [options](const std::string& text) { options->touch_path = text; });
  add_number(app, "--max-rms", "MM", "with --touch: what the pairs may be off by; default 3",
             options->rms_max_mm, 1e-6, 1e3);
  add_text(app, "--verify", "WORK.json",
           "says whether this work plane still lies where it did; exit code 1 when it does not",
           [options](const std::string& text) { options->verify_path = text; });
  add_number(app, "--max-shift", "MM", "with --verify: what it may have moved; default 1",
             options->shift_max_mm, 0.0, 1e4);
  add_number(app, "--max-turn", "DEG", "with --verify: what it may have tilted; default 0.5",
             options->tilt_max_deg, 0.0, 90.0);
  add_reading_and_work(app, options->reading);
  return [options](Report& report) { return run(*options, report); };
}

}  // namespace flatpose::tool
