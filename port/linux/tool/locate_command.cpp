// flatpose locate PART.fpt SCAN

#include <array>
#include <memory>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/locator.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/threads/worker_pool.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/match_text.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/output_file.hpp"
#include "port/linux/tool/overlay.hpp"
#include "port/linux/tool/status_error.hpp"
#include "port/linux/tool/template_io.hpp"

namespace flatpose::tool {
namespace {

constexpr double kTiltMax_deg = 68.0;
constexpr int kThreadsMax = 64;
constexpr double kDeadlineMax_ms = 3'600'000.0;

struct Options {
  std::string part_path;
  std::string scan_path;
  std::string overlay_path;
  ScanOptions reading;
  locate::LocateConfig config;
  double deadline_ms = 0.0;
  int threads = 1;
  bool json = false;
};

locate::Order parse_order(const std::string& text) {
  if (text == "score") return locate::Order::kScore;
  if (text == "height") return locate::Order::kHeight;
  if (text == "visible") return locate::Order::kVisible;
  throw port::InputError("--order", "\"" + text + "\" is no order",
                         "give score, height or visible");
}

void draw(const Options& options, const model::Template& part, const LoadedScan& loaded,
          const locate::LocateResult& result) {
  Overlay overlay;
  overlay.title = formatted("%d of '%s' in %s", result.match_count, part.name.data(),
                            name_of(loaded.path).c_str());
  int number = 0;
  for (const locate::Match& match : result.found())
    overlay.marks.push_back({match.face_T_object, formatted("#%d  %.2f", ++number, match.score)});
  port::write_file_atomically(options.overlay_path, draw_overlay(overlay, part, loaded));
}

ExitCode run(const Options& options, Report& report) {
  const std::array inputs{options.part_path, options.scan_path, options.reading.work_path};
  check_outputs(inputs, std::array{options.overlay_path});
  const auto part = load_template(options.part_path);
  const LoadedScan loaded = load_scan(options.scan_path, options.reading);

  const locate::Limits limits = limits_for(loaded.scan);
  Memory memory(locate::Locator::required_bytes(limits));
  locate::Locator locator;
  if (const Status s = locator.init(limits, memory.span()); s != Status::kOk)
    fail(s, Doing::kLocate, options.scan_path);
  locate::LocateConfig config = options.config;
  config.deadline_us = static_cast<std::int64_t>(options.deadline_ms * 1000.0);
  const auto result = std::make_unique<locate::LocateResult>();
  const port::SteadyClock clock;
  port::WorkerPool workers(options.threads);
  const Status status =
      locator.locate(*part, loaded.scan.view(), loaded.frames, config, {clock, workers}, *result);
  if (status != Status::kOk) fail(status, Doing::kLocate, options.scan_path);

  if (!options.overlay_path.empty()) draw(options, *part, loaded, *result);
  report.text = options.json ? match_json(*part, loaded, *result, memory.size_bytes())
                             : match_table(*part, loaded, *result);
  return result->match_count > 0 ? ExitCode::kDone : ExitCode::kNone;
}

}  // namespace

Action add_locate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  Options& o = *options;
  app.add_option("PART", o.part_path, "template that teach wrote")->required();
  app.add_option("SCAN", o.scan_path, "organized PCD, depth PNG or SICK height map")->required();
  app.add_flag("--json", o.json, "print one JSON object");
  add_count(app, "--max-matches", "N", "how many at most (1)", o.config.max_matches, 1,
            locate::kMatchCountMax);
  add_number(app, "--min-score", "S", "0 to 1 (the part's own threshold)", o.config.min_score, 0.0,
             1.0);
  add_number(app, "--min-visible", "V", "share that must be visible, 0 to 1 (0.5)",
             o.config.min_visible, 0.0, 1.0);
  add_text(app, "--max-tilt", "DEG", "against the work plane (46)", [&o](const std::string& text) {
    o.config.max_tilt_rad = parse_number("--max-tilt", text, 0.0, kTiltMax_deg) * kRadPerDeg;
  });
  add_region(app, "where the part's origin may lie", o.config.region);
  add_text(app, "--order", "score|height|visible", "of the matches (score)",
           [&o](const std::string& text) { o.config.order = parse_order(text); });
  add_number(app, "--resolution", "MM", "cell of the height map (the template's)", o.config.cell_mm,
             1e-3, 1000.0);
  add_count(app, "--threads", "N", "threads to use", o.threads, 1, kThreadsMax);
  add_number(app, "--deadline-ms", "T", "return what is verified by then", o.deadline_ms, 1e-3,
             kDeadlineMax_ms);
  app.add_option("--overlay", o.overlay_path, "picture of the matches")->type_name("OUT.png");
  add_reading_and_work(app, o.reading);
  return [options](Report& report) { return run(*options, report); };
}

}  // namespace flatpose::tool
