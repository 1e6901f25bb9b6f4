#include "bench/scenes/cause.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose::bench {
namespace {

constexpr double kFlip_deg = 45.0;

/// The name of the bound that is broken most.
std::string worst_of(const PoseError& e, const Bounds& bounds) {
  const double position = e.position_mm / bounds.position_mm;
  const double tilt = e.tilt_deg / bounds.tilt_deg;
  const double turn = e.turn_deg / bounds.turn_deg;
  if (position >= tilt && position >= turn) return "position";
  return tilt >= turn ? "tilt" : "turn";
}

double distance_mm(const Pose& a, const Pose& b) { return norm(a.position_mm - b.position_mm); }

/// The other part whose origin is nearest, when the found origin lies on it.
std::string clutter_at(const Pose& scan_T_found, const Shot& shot) {
  std::string name;
  double least_mm = std::numeric_limits<double>::max();
  for (const sim::SimulatedInstance& other : shot.clutter) {
    const double away_mm = distance_mm(scan_T_found, other.scan_T_object);
    if (away_mm > 0.5 * sim::radius_mm(sim::catalogue_part(other.part)) || away_mm >= least_mm)
      continue;
    least_mm = away_mm;
    name = other.part;
  }
  return name;
}

/// The instance whose place the pose takes, whatever its direction.
Nearest instance_at(const Pose& scan_T_found, const Shot& shot, int fold) {
  const double reach_mm = 0.5 * sim::radius_mm(sim::catalogue_part(shot.part));
  Nearest best;
  double least_mm = reach_mm;
  for (int i = 0; i < static_cast<int>(shot.truths.size()); ++i) {
    const double away_mm = distance_mm(scan_T_found, shot.truths[i].scan_T_part);
    if (away_mm > least_mm) continue;
    least_mm = away_mm;
    best = {i, pose_error(scan_T_found, shot.truths[i].scan_T_part, fold)};
  }
  return best;
}

std::string cause_of_wrong(const Pose& scan_T_found, const Shot& shot, int fold) {
  const Nearest near = instance_at(scan_T_found, shot, fold);
  const std::string other = clutter_at(scan_T_found, shot);
  if (!near.instance || (!other.empty() && near.error.position_mm > 2.0 * kCoarse.position_mm))
    return other.empty() ? "false_match" : "false_match_on_" + other;
  if (near.error.tilt_deg > 90.0) return "upside_down";
  if (near.error.turn_deg > kFlip_deg) return "flip";
  return worst_of(near.error, kCoarse);
}

}  // namespace

std::string cause_of_first(const Trial& trial, const Shot& shot, int fold, bool expects_target) {
  const FirstVerdict& first = trial.first;
  if (expects_target && !first.has_target) return "no_target";
  if (first.is_fine) return "";
  if (first.is_coarse) return "fine_" + worst_of(first.nearest.error, kFine);
  if (!first.has_answer) return expects_target ? "not_found" : "";
  if (first.nearest.instance && is_within(first.nearest.error, kCoarse)) return "hidden_instance";
  return cause_of_wrong(trial.scan_T_found.front(), shot, fold);
}

std::string cause_of_all(const Trial& trial) {
  std::string words;
  const auto add = [&words](bool applies, const char* word) {
    if (!applies) return;
    if (!words.empty()) words += '+';
    words += word;
  };
  add(!trial.all.wrong_matches.empty(), "wrong");
  add(!trial.all.double_matches.empty(), "double");
  add(!trial.all.missed.empty(), "missed");
  return words;
}

Probe probe(Searcher& searcher, const Shot& shot, const Taught& taught, const Truth& truth) {
  constexpr double kReach_mm = 10.0;
  constexpr int kMatches = 8;
  const Pose scan_T_object = truth.scan_T_part * taught.object_T_part.inverse();
  locate::LocateConfig config;
  config.max_matches = kMatches;
  config.min_score = 0.0;
  config.min_visible = 0.0;
  config.region.kind = Region::Kind::kCircle;
  config.region.x_mm = scan_T_object.position_mm.x;
  config.region.y_mm = scan_T_object.position_mm.y;
  config.region.radius_mm = kReach_mm;
  const locate::LocateResult result = searcher.locate(shot, taught.part, config);
  Probe best;
  for (const locate::Match& match : result.found()) {
    const PoseError error =
        pose_error(match.face_T_object * taught.object_T_part, truth.scan_T_part, taught.fold);
    if (!is_within(error, kCoarse) || match.score <= best.score) continue;
    best = {true, match.score, match.visible};
  }
  return best;
}

std::string stage_of(const Probe& probe, const Taught& taught, const locate::LocateConfig& config) {
  if (!probe.is_found) return "search";
  const bool passes =
      probe.score >= taught.part.score_threshold && probe.visible >= config.min_visible;
  return passes ? "competition" : "verification";
}

}  // namespace flatpose::bench
