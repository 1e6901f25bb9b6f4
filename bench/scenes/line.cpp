#include "bench/scenes/line.hpp"

#include <cinttypes>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace flatpose::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

void add_pose(Json& json, const Pose& pose) {
  json["position_mm"] = json_of(pose.position_mm);
  json["rotation"] = pose.rotation.m;
}

Json json_of(const PoseError& e) {
  return {{"position_mm", e.position_mm},
          {"in_plane_mm", e.in_plane_mm},
          {"z_mm", e.z_mm},
          {"tilt_deg", e.tilt_deg},
          {"turn_deg", e.turn_deg}};
}

Json json_of(const locate::Timings& t) {
  return {{"rectify", t.rectify_us}, {"features", t.features_us}, {"search", t.search_us},
          {"refine", t.refine_us},   {"verify", t.verify_us},     {"total", t.total_us}};
}

Json first_of(const FirstVerdict& first) {
  Json json{{"has_target", first.has_target},
            {"has_answer", first.has_answer},
            {"coarse", first.is_coarse},
            {"fine", first.is_fine}};
  if (first.nearest.instance) {
    json["instance"] = *first.nearest.instance;
    json["error"] = json_of(first.nearest.error);
  }
  return json;
}

Json matches_of(const Record& record) {
  Json list = Json::array();
  for (int i = 0; i < record.trial.result.match_count; ++i) {
    const locate::Match& match = record.trial.result.matches[i];
    Json json{{"score", match.score}, {"visible", match.visible}};
    add_pose(json, record.trial.scan_T_found[i]);
    const Nearest near =
        nearest(record.trial.scan_T_found[i], record.shot.truths, record.taught.fold);
    if (near.instance) {
      json["instance"] = *near.instance;
      json["error"] = json_of(near.error);
    }
    list.push_back(std::move(json));
  }
  return list;
}

Json truths_of(const Shot& shot) {
  Json list = Json::array();
  for (const Truth& truth : shot.truths) {
    Json json{{"visible", truth.visible}};
    add_pose(json, truth.scan_T_part);
    list.push_back(std::move(json));
  }
  return list;
}

Json lost_of(const std::vector<Lost>& lost) {
  Json list = Json::array();
  for (const Lost& one : lost) {
    list.push_back({{"instance", one.instance},
                    {"stage", one.stage},
                    {"score", one.probe.score},
                    {"visible", one.probe.visible}});
  }
  return list;
}

std::string digest_text(const locate::LocateResult& result) {
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, locate::digest(result));
  return text;
}

}  // namespace

std::string json_line(const Record& record) {
  const Trial& trial = record.trial;
  Json json{{"scene", record.shot.scene},
            {"part", record.shot.part},
            {"seed", record.shot.seed},
            {"sensor", record.sensor},
            {"max_matches", record.max_matches},
            {"expects_target", record.expects_target},
            {"status", to_string(trial.result.outcome)},
            {"cause", record.cause}};
  json["threshold"] = record.taught.part.score_threshold;
  json["best_rejected"] = trial.result.best_rejected_score;
  json["rival"] = trial.result.rival_score;
  json["first"] = first_of(trial.first);
  json["all"] = {{"wanted", trial.all.wanted_count},
                 {"found", trial.all.found_count},
                 {"missed", trial.all.missed},
                 {"wrong", trial.all.wrong_matches},
                 {"double", trial.all.double_matches}};
  json["lost"] = lost_of(record.lost);
  json["matches"] = matches_of(record);
  json["truth"] = truths_of(record.shot);
  json["timings_us"] = json_of(trial.result.timings);
  json["hypotheses"] = trial.result.hypothesis_count;
  json["candidates"] = trial.result.candidate_count;
  json["peak_bytes"] = trial.result.peak_bytes;
  json["digest"] = digest_text(trial.result);
  json["picture"] = record.picture;
  return json.dump();
}

}  // namespace flatpose::bench
