// flatpose info FILE

#include <memory>

#include "flatpose/core/maths.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/robot_file.hpp"
#include "port/linux/files/sick_json.hpp"
#include "port/linux/files/work_file.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/pose_json.hpp"
#include "port/linux/tool/scan_survey.hpp"
#include "port/linux/tool/template_io.hpp"

namespace flatpose::tool {
namespace {

struct Options {
  std::string path;
  ScanOptions reading;
  bool json = false;
};

enum class Kind { kTemplate, kWork, kRobot, kScan };

// Scans may be JSON too; only alignments say so of themselves.
Kind kind_of(const Options& options) {
  const std::vector<std::byte> bytes =
      port::read_file(options.path, options.reading.limits.max_file_bytes);
  if (is_template(bytes)) return Kind::kTemplate;
  constexpr std::size_t kAlignmentBytesMax = 16 * 1024 * 1024;
  if (bytes.size() > kAlignmentBytesMax || !port::is_json(bytes)) return Kind::kScan;
  const std::string_view text = port::as_text(bytes);
  if (text.find("\"flatpose-work\"") != std::string_view::npos) return Kind::kWork;
  return text.find("\"flatpose-robot\"") != std::string_view::npos ? Kind::kRobot : Kind::kScan;
}

std::string symmetry_text(const model::Template& part) {
  if (part.symmetry.order == model::kFullSymmetry) return "full";
  return part.symmetry.order == 1 ? "none" : formatted("%d-fold", part.symmetry.order);
}

std::string template_text(const std::string& path, const model::Template& part) {
  const Vec3& p = part.scan_T_object.position_mm;
  std::string text = formatted("%s: template '%s'\n", path.c_str(), part.name.data());
  text += formatted("  threshold %.3f; scored %.3f itself, %.3f the best wrong place\n",
                    part.score_threshold, part.self_score, part.rival_score);
  text +=
      formatted("  %d contour and %d surface points, %d anchors, symmetry %s\n", part.contour_count,
                part.surface_count, part.anchor_count, symmetry_text(part).c_str());
  text += formatted("  %.0f mm2, reach %.1f mm from its first anchor, step %.2f mm, cell %.3f mm\n",
                    part.area_mm2, part.radius_mm, part.step_mm, part.cell_mm);
  text += formatted(
      "  taught at %.3f %.3f %.3f mm (frame %s, up %s), points every %.3f mm, "
      "noise %.3f mm\n",
      p.x, p.y, p.z, part.frame == model::Frame::kWork ? "work" : "scan", part.up > 0 ? "+z" : "-z",
      part.pitch_mm, part.noise_mm);
  for (const WeakPoint& weak : weak_points(part)) text += "  weak: " + weak.sentence + "\n";
  return text;
}

void tell_template(const Options& options, Report& report) {
  const auto part = load_template(options.path);
  if (!options.json) {
    report.text = template_text(options.path, *part);
    return;
  }
  Json json = {{"kind", "template"}};
  json.update(json_of(*part));
  report.text = line_of(json);
}

void tell_work(const Options& options, Report& report) {
  const port::WorkFile work = port::read_work_file(options.path);
  const Pose scan_T_work = work.work_T_scan.inverse();
  const double tilt_deg = arc_cosine(std::fabs(scan_T_work.rotation.m[8])) * kDegPerRad;
  if (options.json) {
    Json json;
    json["kind"] = "work";
    json["up"] = port::to_string(work.up);
    json["tilt_deg"] = tilt_deg;
    add_pose(json["work_T_scan"], work.work_T_scan);
    if (work.quality) {
      json["quality"] = {{"plane_rms_mm", work.quality->plane_rms_mm},
                         {"inlier_share", work.quality->inlier_share},
                         {"inlier_count", work.quality->inlier_count}};
    }
    report.text = line_of(json);
    return;
  }
  const Vec3& p = scan_T_work.position_mm;
  report.text = formatted(
      "%s: work plane, up %s, tilt %.3f deg, origin at %.3f %.3f %.3f mm of "
      "the scan\n",
      options.path.c_str(), port::to_string(work.up), tilt_deg, p.x, p.y, p.z);
  if (work.quality)
    report.text += formatted("  rms %.4f mm, %.1f %% of the points\n", work.quality->plane_rms_mm,
                             100.0 * work.quality->inlier_share);
}

void tell_robot(const Options& options, Report& report) {
  const port::RobotFile robot = port::read_robot_file(options.path);
  if (options.json) {
    Json json;
    json["kind"] = "robot";
    add_pose(json["robot_T_scan"], robot.robot_T_scan);
    if (robot.quality) {
      json["quality"] = {{"rms_mm", robot.quality->rms_mm},
                         {"worst_mm", robot.quality->worst_mm},
                         {"leave_one_out_mm", robot.quality->leave_one_out_mm}};
    }
    report.text = line_of(json);
    return;
  }
  const Vec3& p = robot.robot_T_scan.position_mm;
  report.text = formatted("%s: robot frame, the scan's origin at %.3f %.3f %.3f mm of the robot\n",
                          options.path.c_str(), p.x, p.y, p.z);
  if (robot.quality)
    report.text += formatted("  %.4f mm rms, worst %.4f, left out %.4f\n", robot.quality->rms_mm,
                             robot.quality->worst_mm, robot.quality->leave_one_out_mm);
}

/// The bounding box in the scan's own frame: the survey's stands in the flipped one.
struct Box3 {
  Vec3 min_mm;
  Vec3 max_mm;
};
Box3 box_in_scan(const rectify::Survey& survey, const Frames& frames) {
  const Pose scan_T_work = frames.work_T_scan.inverse();
  const Vec3 a = scan_T_work * survey.min_mm;
  const Vec3 b = scan_T_work * survey.max_mm;
  return {{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
          {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}};
}

std::string scan_json(const LoadedScan& loaded, const rectify::Survey& survey, const Box3& box) {
  Json json;
  json["kind"] = "scan";
  json["width_px"] = loaded.scan.width_px;
  json["height_px"] = loaded.scan.height_px;
  json["valid_count"] = survey.valid_count;
  json["missing_share"] = survey.missing_share;
  if (survey.valid_count > 0) {
    json["min_mm"] = json_of(box.min_mm);
    json["max_mm"] = json_of(box.max_mm);
    json["pitch_mm"] = Json::array({survey.pitch_along_row_mm, survey.pitch_along_column_mm});
    json["noise_mm"] = survey.noise_sigma_mm;
  } else {
    for (const char* key : {"min_mm", "max_mm", "pitch_mm", "noise_mm"}) json[key] = nullptr;
  }
  json["up"] = port::to_string(loaded.scan.up);
  json["up_reason"] = loaded.scan.up_reason;
  json["simulated"] = loaded.scan.is_simulated;
  return line_of(json);
}

void tell_scan(const Options& options, Report& report) {
  const LoadedScan loaded = load_scan(options.path, options.reading);
  const rectify::Survey survey = survey_of(loaded);
  const Box3 box = box_in_scan(survey, loaded.frames);
  if (options.json) {
    report.text = scan_json(loaded, survey, box);
    return;
  }
  report.text = formatted("%s: %sscan of %d x %d points, %.1f %% missing, up %s by %s\n",
                          options.path.c_str(), loaded.scan.is_simulated ? "simulated " : "",
                          loaded.scan.width_px, loaded.scan.height_px, 100.0 * survey.missing_share,
                          port::to_string(loaded.scan.up), loaded.scan.up_reason.c_str());
  if (survey.valid_count == 0) {
    report.text += "  every point is missing\n";
    return;
  }
  report.text += formatted("  x %.3f to %.3f, y %.3f to %.3f, z %.3f to %.3f mm\n", box.min_mm.x,
                           box.max_mm.x, box.min_mm.y, box.max_mm.y, box.min_mm.z, box.max_mm.z);
  report.text += formatted(
      "  points every %.4f mm along rows, %.4f mm along columns; noise %.4f "
      "mm\n",
      survey.pitch_along_row_mm, survey.pitch_along_column_mm, survey.noise_sigma_mm);
}

ExitCode run(const Options& options, Report& report) {
  switch (kind_of(options)) {
    case Kind::kTemplate: tell_template(options, report); break;
    case Kind::kWork: tell_work(options, report); break;
    case Kind::kRobot: tell_robot(options, report); break;
    case Kind::kScan: tell_scan(options, report); break;
  }
  return ExitCode::kDone;
}

}  // namespace

Action add_info(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("FILE", options->path, "template, scan or work file")->required();
  app.add_flag("--json", options->json, "print one JSON object");
  add_reading(app, options->reading);
  return [options](Report& report) { return run(*options, report); };
}

}  // namespace flatpose::tool
