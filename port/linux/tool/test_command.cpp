// flatpose test PART.fpt SCAN...: how well the part will work, and what is weak.

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/model/equivalents.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/tool/command.hpp"
#include "port/linux/tool/engine.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/options.hpp"
#include "port/linux/tool/pose_json.hpp"
#include "port/linux/tool/status_error.hpp"
#include "port/linux/tool/template_io.hpp"

namespace flatpose::tool {
namespace {

// The scan is seen through slightly other cells: what then moves is not of the part.
constexpr double kCellFactors[] = {1.0, 0.93, 1.07};
constexpr double kMarginThin = 0.08;

struct Options {
  std::string part_path;
  std::vector<std::string> scan_paths;
  ScanOptions reading;
  Region region;
  bool json = false;
};

struct Trial {
  std::string path;
  locate::Outcome outcome = locate::Outcome::kNoMatch;
  std::optional<locate::Match> best;
  double over_threshold = 0.0;
  double rejected_score = 0.0;  ///< The best that was refused, or stood in the match's place.
  int repeats = 0;              ///< Runs with other cells in which the part was found again.
  double position_spread_mm = 0.0;
  double rotation_spread_deg = 0.0;

  [[nodiscard]] bool repeats_all() const noexcept {
    return repeats == static_cast<int>(std::size(kCellFactors));
  }
};

double angle_deg(const model::Template& part, const locate::Match& a, const locate::Match& b) {
  const Rotation& ra = a.face_T_object.rotation;
  const Rotation& rb = b.face_T_object.rotation;
  if (part.symmetry.order == model::kFullSymmetry)
    return arc_cosine(dot(ra.column(2), rb.column(2))) * kDegPerRad;
  double least_rad = angle_between_rad(ra, rb);
  for (int i = 1; i < part.symmetry.order; ++i) {
    const Pose turned = model::turned_about_symmetry(b.face_T_object, part.symmetry,
                                                     2.0 * kPi * i / part.symmetry.order);
    least_rad = std::min(least_rad, angle_between_rad(ra, turned.rotation));
  }
  return least_rad * kDegPerRad;
}

class Tester {
 public:
  Tester(const model::Template& part, const LoadedScan& loaded, const Region& region)
      : part_(part),
        loaded_(loaded),
        limits_(limits_for(loaded.scan)),
        memory_(locate::Locator::required_bytes(limits_)),
        result_(std::make_unique<locate::LocateResult>()) {
    config_.region = region;
    if (const Status s = locator_.init(limits_, memory_.span()); s != Status::kOk)
      fail(s, Doing::kLocate, loaded.path);
  }

  Trial run() {
    Trial trial;
    trial.path = loaded_.path;
    for (const double factor : kCellFactors) {
      find(factor);
      if (factor == 1.0) note_first(trial);
      if (!trial.best) break;
      if (result_->match_count > 0) note_spread(trial, result_->matches[0]);
    }
    return trial;
  }

 private:
  void find(double factor) {
    config_.cell_mm = factor * part_.cell_mm;
    const Status s = locator_.locate(part_, loaded_.scan.view(), loaded_.frames, config_,
                                     port::SteadyClock{}, *result_);
    if (s != Status::kOk) fail(s, Doing::kLocate, loaded_.path);
  }

  void note_first(Trial& trial) {
    trial.outcome = result_->outcome;
    trial.rejected_score = std::max(result_->best_rejected_score, result_->rival_score);
    if (result_->match_count == 0) return;
    trial.best = result_->matches[0];
    trial.over_threshold = trial.best->score - part_.score_threshold;
    look_near(trial.best->face_T_object.position_mm);
  }

  // What follows looks for the same one of several.
  void look_near(const Vec3& position_mm) {
    config_.region = Region{};
    config_.region.kind = Region::Kind::kCircle;
    config_.region.x_mm = position_mm.x;
    config_.region.y_mm = position_mm.y;
    config_.region.radius_mm = 0.5 * part_.radius_mm;
  }

  void note_spread(Trial& trial, const locate::Match& again) const {
    const double off_mm =
        norm(again.face_T_object.position_mm - trial.best->face_T_object.position_mm);
    ++trial.repeats;
    trial.position_spread_mm = std::max(trial.position_spread_mm, off_mm);
    trial.rotation_spread_deg =
        std::max(trial.rotation_spread_deg, angle_deg(part_, *trial.best, again));
  }

  const model::Template& part_;
  const LoadedScan& loaded_;
  locate::Limits limits_;
  Memory memory_;
  locate::Locator locator_;
  locate::LocateConfig config_;
  std::unique_ptr<locate::LocateResult> result_;
};

struct Verdict {
  const char* word;
  std::string sentence;
};

Verdict judge(const model::Template& part, const std::vector<Trial>& trials) {
  const auto count = [&trials](auto&& is) {
    return static_cast<int>(std::count_if(trials.begin(), trials.end(), is));
  };
  const int all = static_cast<int>(trials.size());
  const int found = count([](const Trial& t) { return t.best.has_value(); });
  if (found == 0) return {"fails", "not found in any scan: teach it again from a scan like these"};
  if (found < all)
    return {"unreliable", formatted("found in %d of %d scans: teach from more scans, or see why it "
                                    "is hidden in the others",
                                    found, all)};
  if (count([](const Trial& t) { return !t.repeats_all(); }) > 0)
    return {"unreliable", "lost when the scan is seen through slightly other cells"};
  const int ambiguous =
      count([](const Trial& t) { return t.outcome == locate::Outcome::kAmbiguous; });
  if (ambiguous > 0)
    return {"weak",
            "a second pose explains the part about as well: declare its symmetry or teach "
            "more of its contour"};
  if (count([](const Trial& t) { return t.over_threshold < kMarginThin; }) > 0)
    return {"weak", "its score lies close to the threshold: teach from more scans"};
  if (part.weakness != 0) return {"usable", "found in every scan; mind what is weak"};
  return {"good", "found in every scan with a clear margin"};
}

Json trial_object(const Trial& trial) {
  Json json;
  json["scan"] = trial.path;
  json["status"] = locate::to_string(trial.outcome);
  json["rejected_score"] = trial.rejected_score;
  if (!trial.best) return json;
  const locate::Match& best = *trial.best;
  json["score"] = best.score;
  json["visible"] = best.visible;
  json["margin_over_threshold"] = trial.over_threshold;
  json["margin_over_rejected"] = best.score - trial.rejected_score;
  add_pose(json, best.face_T_object);
  json["sigma_mm"] = json_of(best.sigma_mm);
  json["sigma_deg"] = json_of(kDegPerRad * best.sigma_rad);
  if (best.turn_is_free) json["sigma_deg"][2] = nullptr;
  json["edge_rms_mm"] = best.edge_rms_mm;
  json["surface_rms_mm"] = best.surface_rms_mm;
  json["repeats"] = trial.repeats;
  json["position_spread_mm"] = trial.position_spread_mm;
  json["rotation_spread_deg"] = trial.rotation_spread_deg;
  return json;
}

std::string json_text(const model::Template& part, const std::vector<Trial>& trials,
                      const Verdict& verdict) {
  Json json;
  json["part"] = part.name.data();
  json["threshold"] = part.score_threshold;
  json["scans"] = Json::array();
  for (const Trial& trial : trials) json["scans"].push_back(trial_object(trial));
  json["weakness"] = Json::array();
  for (const WeakPoint& weak : weak_points(part))
    json["weakness"].push_back({{"word", weak.word}, {"sentence", weak.sentence}});
  json["verdict"] = verdict.word;
  json["verdict_sentence"] = verdict.sentence;
  return line_of(json);
}

std::string plain_text(const Trial& trial) {
  std::string text = trial.path + "\n";
  if (!trial.best)
    return text + formatted("  %s; best that was refused scored %.3f\n",
                            locate::to_string(trial.outcome), trial.rejected_score);
  const locate::Match& best = *trial.best;
  text += formatted(
      "  %s: score %.3f (%+.3f over the threshold, %+.3f over the best refused), "
      "visible %.3f\n",
      locate::to_string(trial.outcome), best.score, trial.over_threshold,
      best.score - trial.rejected_score, best.visible);
  text += formatted("  sigma %.3f %.3f %.3f mm; contour rms %.3f mm, surface rms %.3f mm\n",
                    best.sigma_mm.x, best.sigma_mm.y, best.sigma_mm.z, best.edge_rms_mm,
                    best.surface_rms_mm);
  text += formatted(
      "  found again in %d of %zu runs with other cells, within %.3f mm and %.3f "
      "deg\n",
      trial.repeats, std::size(kCellFactors), trial.position_spread_mm, trial.rotation_spread_deg);
  return text;
}

std::string plain_text(const model::Template& part, const std::vector<Trial>& trials,
                       const Verdict& verdict) {
  std::string text =
      formatted("part '%s', threshold %.3f\n", part.name.data(), part.score_threshold);
  for (const Trial& trial : trials) text += plain_text(trial);
  for (const WeakPoint& weak : weak_points(part)) text += "weak: " + weak.sentence + "\n";
  return text + "verdict: " + verdict.word + ": " + verdict.sentence + "\n";
}

ExitCode run(const Options& options, Report& report) {
  const auto part = load_template(options.part_path);
  std::vector<Trial> trials;
  for (const std::string& path : options.scan_paths) {
    const LoadedScan loaded = load_scan(path, options.reading);
    trials.push_back(Tester(*part, loaded, options.region).run());
  }
  const Verdict verdict = judge(*part, trials);
  report.text =
      (options.json ? json_text(*part, trials, verdict) : plain_text(*part, trials, verdict));
  const bool found = std::any_of(trials.begin(), trials.end(),
                                 [](const Trial& trial) { return trial.best.has_value(); });
  return found ? ExitCode::kDone : ExitCode::kNone;
}

}  // namespace

Action add_test(CLI::App& app) {
  auto options = std::make_shared<Options>();
  Options& o = *options;
  app.add_option("PART", o.part_path, "template that teach wrote")->required();
  app.add_option("SCAN", o.scan_paths, "scans that show the part")->required();
  app.add_flag("--json", o.json, "print one JSON object");
  add_region(app, "where the part's origin may lie", o.region);
  add_reading_and_work(app, o.reading);
  return [options](Report& report) { return run(*options, report); };
}

}  // namespace flatpose::tool
