// flatpose teach SCAN [SCAN...] -o PART.fpt

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "flatpose/teach/teacher.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/mask_png.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/output_file.hpp"
#include "port/linux/tool/overlay.hpp"
#include "port/linux/tool/pose_json.hpp"
#include "port/linux/tool/status_error.hpp"
#include "port/linux/tool/template_io.hpp"

namespace flatpose::tool {
namespace {

constexpr int kSymmetryOrderMax = 64;
constexpr std::size_t kScanCountMax = 64;

struct Options {
  std::vector<std::string> scan_paths;
  std::string part_path;
  std::string mask_path;
  std::string preview_path;
  std::string name;
  ScanOptions reading;
  teach::TeachConfig config;
  bool json = false;
};

teach::PlanePoint parse_point(const std::string& option, const std::string& text,
                              const std::string& form) {
  const std::vector<double> numbers = parse_numbers(option, text, 2, form);
  return {true, numbers[0], numbers[1]};
}

teach::PlanePoint parse_direction(const std::string& text) {
  const teach::PlanePoint p = parse_point("--x-axis", text, "DX,DY");
  if (std::hypot(p.x_mm, p.y_mm) < 1e-9)
    throw port::InputError("--x-axis", "0,0 is no direction", "give one, for example 1,0");
  return p;
}

int parse_symmetry(const std::string& text) {
  if (text == "full") return model::kFullSymmetry;
  return static_cast<int>(parse_whole("--symmetry", text, 1, kSymmetryOrderMax));
}

/// The name for the template: as given, or the output file's, cut where it is too long.
std::array<char, model::kNameBytesMax + 1> chosen_name(const Options& options) {
  constexpr std::size_t kBytesMax = model::kNameBytesMax;
  std::string name = options.name;
  if (name.empty()) {
    name = port::printable(stem_of(options.part_path), kBytesMax);
  } else if (name.size() > kBytesMax || port::printable(name, kBytesMax) != name) {
    throw port::InputError("--name", "\"" + name + "\" is too long or not printable",
                           "give a name of at most " + std::to_string(kBytesMax) + " bytes");
  }
  std::array<char, model::kNameBytesMax + 1> bytes{};
  std::memcpy(bytes.data(), name.data(), std::min(name.size(), kBytesMax));
  return bytes;
}

/// Everything that teach reads, kept as long as it works.
struct Lesson {
  std::vector<LoadedScan> scans;
  port::LabelMask mask;
  std::string mask_path;
  teach::TeachConfig config;
};

[[noreturn]] void fail_lesson(Status status, const Lesson& lesson) {
  // These the paint decides, where there is one; all else is the scan's.
  const bool is_of_outline =
      status == Status::kNoPart || status == Status::kNoContour || status == Status::kTooFewPoints;
  if (is_of_outline && !lesson.mask_path.empty())
    fail(status, Doing::kTeachByMask, lesson.mask_path);
  fail(status, Doing::kTeach, lesson.scans.front().path);
}

Lesson load(const Options& options) {
  Lesson lesson;
  lesson.config = options.config;
  lesson.config.name = chosen_name(options);
  for (const std::string& path : options.scan_paths) {
    lesson.scans.push_back(load_scan(path, options.reading));
    require_points(lesson.scans.back());
  }
  const LoadedScan& first = lesson.scans.front();
  lesson.config.up = static_cast<std::int8_t>(first.up_sign());
  lesson.config.frame =
      first.frame == job::FrameName::kWork ? model::Frame::kWork : model::Frame::kScan;
  if (options.mask_path.empty()) return lesson;
  lesson.mask_path = options.mask_path;
  lesson.mask = port::read_mask_png(options.mask_path, first.scan.width_px, first.scan.height_px,
                                    options.reading.limits);
  lesson.config.labels = lesson.mask.view();
  if (lesson.mask.origin)
    lesson.config.label_origin_px = {true, lesson.mask.origin->column_px,
                                     lesson.mask.origin->row_px};
  return lesson;
}

void learn(const Lesson& lesson, model::Template& part, teach::TeachReport& found) {
  locate::Limits limits = limits_for(lesson.scans.front().scan);
  std::vector<teach::TeachScan> scans;
  for (const LoadedScan& loaded : lesson.scans) {
    limits = larger(limits, limits_for(loaded.scan));
    scans.push_back({loaded.scan.view(), loaded.frames});
  }
  Memory memory(teach::Teacher::required_bytes(limits));
  teach::Teacher teacher;
  Status status = teacher.init(limits, memory.span());
  if (status == Status::kOk) status = teacher.teach(scans, lesson.config, part, found);
  if (status != Status::kOk) fail_lesson(status, lesson);
}

std::string json_report(const model::Template& part, const LoadedScan& first,
                        const teach::TeachReport& found, std::size_t scan_count) {
  Json json = json_of(part);
  json["frame"] = first.frame_name();
  json["up"] = port::to_string(first.scan.up);
  json["up_reason"] = first.scan.up_reason;
  json["scans_given"] = scan_count;
  json["scans_used"] = found.scan_count_used;
  json["contour_rms_mm"] = found.contour_rms_mm;
  json["flatness_rms_mm"] = found.flatness_rms_mm;
  return line_of(json);
}

std::string text_report(const model::Template& part, const LoadedScan& first,
                        const teach::TeachReport& found, std::size_t scan_count) {
  const Vec3& p = part.scan_T_object.position_mm;
  std::string text =
      formatted("taught '%s' from %d of %zu scans (frame %s, up %s by %s)\n", part.name.data(),
                found.scan_count_used, scan_count, first.frame_name(),
                port::to_string(first.scan.up), first.scan.up_reason.c_str());
  text += formatted("  threshold %.3f; scores %.3f itself, %.3f the best wrong place\n",
                    part.score_threshold, part.self_score, part.rival_score);
  text += formatted("  %d contour and %d surface points, %.0f mm2, step %.2f mm\n",
                    part.contour_count, part.surface_count, part.area_mm2, part.step_mm);
  text += formatted("  reach %.1f mm from its first anchor\n", part.radius_mm);
  text += formatted("  cell %.3f mm, points every %.3f mm, noise %.3f mm\n", part.cell_mm,
                    part.pitch_mm, part.noise_mm);
  text += formatted("  taught at %.3f %.3f %.3f mm\n", p.x, p.y, p.z);
  return text;
}

std::vector<std::byte> preview(const model::Template& part, const LoadedScan& first) {
  Overlay overlay;
  overlay.title =
      formatted("'%s' as taught from %s", part.name.data(), name_of(first.path).c_str());
  overlay.marks.push_back({part.scan_T_object, part.name.data()});
  overlay.shows_template = true;
  return draw_overlay(overlay, part, first);
}

ExitCode run(const Options& options, Report& report) {
  if (options.scan_paths.size() > kScanCountMax)
    throw port::InputError("teach", std::to_string(options.scan_paths.size()) + " scans",
                           "give at most " + std::to_string(kScanCountMax));
  std::vector<std::string> inputs = options.scan_paths;
  inputs.push_back(options.mask_path);
  inputs.push_back(options.reading.work_path);
  check_outputs(inputs, std::array{options.part_path, options.preview_path});
  const Lesson lesson = load(options);
  const LoadedScan& first = lesson.scans.front();
  const auto part = std::make_unique<model::Template>();
  teach::TeachReport found;
  learn(lesson, *part, found);

  for (const WeakPoint& weak : weak_points(*part)) report.warnings.push_back(weak.sentence);
  const int left_out = static_cast<int>(lesson.scans.size()) - found.scan_count_used;
  if (left_out > 0)
    report.warnings.push_back(
        formatted("%d of %zu scans were left out: the part was not found in them", left_out,
                  lesson.scans.size()));
  FirstOutput output(options.part_path);
  port::write_file_atomically(options.part_path, template_bytes(*part));
  if (!options.preview_path.empty())
    port::write_file_atomically(options.preview_path, preview(*part, first));
  output.keep();
  report.text =
      (options.json ? json_report : text_report)(*part, first, found, lesson.scans.size());
  return ExitCode::kDone;
}

}  // namespace

Action add_teach(CLI::App& app) {
  auto options = std::make_shared<Options>();
  Options& o = *options;
  app.add_option("SCAN", o.scan_paths, "of the part; more take the sensor's grid out of it")
      ->required();
  app.add_option("-o,--output", o.part_path, "the template")->type_name("PART.fpt")->required();
  app.add_option("--name", o.name, "of the part (the output's)")->type_name("N");
  add_region(app, "where the part lies in the first scan", o.config.region);
  app.add_option("--mask", o.mask_path, "labelled picture: red edges, blue surface, green origin")
      ->type_name("MASK.png")
      ->excludes("--region");
  add_text(app, "--origin", "X,Y", "of the object frame (centroid of the surface)",
           [&o](const std::string& t) { o.config.origin = parse_point("--origin", t, "X,Y"); });
  add_text(app, "--x-axis", "DX,DY", "of the object frame (the scan's x)",
           [&o](const std::string& t) { o.config.x_axis = parse_direction(t); });
  add_text(app, "--symmetry", "N|full", "turns that leave it as it is (1)",
           [&o](const std::string& t) { o.config.symmetry_order = parse_symmetry(t); });
  add_text(app, "--symmetry-center", "X,Y", "of these turns (the contour's own centre)",
           [&o](const std::string& t) {
             o.config.symmetry_center = parse_point("--symmetry-center", t, "X,Y");
           })
      ->needs("--symmetry");
  app.add_option("--preview", o.preview_path, "picture of what was taught")->type_name("OUT.png");
  app.add_flag("--json", o.json, "print one JSON object");
  add_reading_and_work(app, o.reading);
  return [options](Report& report) { return run(*options, report); };
}

}  // namespace flatpose::tool
