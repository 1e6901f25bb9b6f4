// flatpose align --touch PAIRS.csv -o ROBOT.json

#include <array>

#include "port/linux/files/touch_file.hpp"
#include "port/linux/files/work_file.hpp"
#include "port/linux/tool/align_options.hpp"
#include "port/linux/tool/output_file.hpp"
#include "port/linux/tool/touch_fit.hpp"

namespace flatpose::tool {
namespace {

constexpr std::size_t kPairsShownMax = 20;

std::string told(const AlignOptions& options, const TouchFit& fit, const port::RobotFile& robot) {
  std::string text = formatted(
      "robot frame of %s: %zu pairs, %.3f mm rms, worst %.3f mm (line %d), left out %.3f mm\n",
      options.touch_path.c_str(), robot.pairs.size(), fit.rms_mm, fit.worst_mm, fit.worst_line,
      fit.leave_one_out_mm);
  std::size_t shown = 0;
  for (const port::TouchedPair& pair : robot.pairs) {
    if (++shown > kPairsShownMax) break;
    text += formatted("  line %d: off by %.3f mm\n", pair.line, pair.residual_mm);
  }
  const Vec3& p = robot.robot_T_scan.position_mm;
  const Vec3 z = robot.robot_T_scan.rotation.column(2);
  text += formatted(
      "  the scan's origin is at %.3f %.3f %.3f mm of the robot, its z points along %.3f %.3f "
      "%.3f\n",
      p.x, p.y, p.z, z.x, z.y, z.z);
  if (fit.is_flat)
    text +=
        "  all points lie in one plane: columns exchanged on one side would fit as well, with z "
        "the "
        "wrong way round\n";
  return text;
}

}  // namespace

ExitCode align_touch(const AlignOptions& options, Report& report) {
  check_outputs(std::array{options.touch_path}, std::array{options.output_path});
  std::vector<port::TouchedPair> pairs = port::read_touch_file(options.touch_path);
  if (!options.reading.work_path.empty()) {
    const Pose work_T_scan = port::read_work_file(options.reading.work_path).work_T_scan;
    const Pose scan_T_work = work_T_scan.inverse();
    for (port::TouchedPair& pair : pairs) pair.scan_mm = scan_T_work * pair.scan_mm;
  }
  const TouchFit fit = fit_touched(options.touch_path, pairs, options.rms_max_mm);
  const port::RobotFile robot{fit.robot_T_scan,
                              port::RobotQuality{fit.rms_mm, fit.worst_mm, fit.leave_one_out_mm},
                              std::move(pairs)};
  port::write_robot_file(options.output_path, robot);
  report.text = told(options, fit, robot);
  return ExitCode::kDone;
}

}  // namespace flatpose::tool
