#include "port/linux/tool/match_json.hpp"

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/outcome.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

Json timings_object(const locate::Timings& timings, std::int64_t load_us) {
  Json json;
  json["load"] = load_us;
  json["rectify"] = timings.rectify_us;
  json["features"] = timings.features_us;
  json["search"] = timings.search_us;
  json["refine"] = timings.refine_us;
  json["verify"] = timings.verify_us;
  json["total"] = timings.total_us;
  return json;
}

}  // namespace

Json json_of(const locate::Match& match) {
  Json json;
  json["score"] = match.score;
  json["visible"] = match.visible;
  add_pose(json, match.face_T_object);
  json["sigma_mm"] = json_of(match.sigma_mm);
  json["sigma_deg"] = json_of(kDegPerRad * match.sigma_rad);
  if (match.turn_is_free) json["sigma_deg"][2] = nullptr;
  json["edge_rms_mm"] = match.edge_rms_mm;
  json["surface_rms_mm"] = match.surface_rms_mm;
  return json;
}

Json json_of(const model::Template& part, const LoadedScan& loaded,
             const locate::LocateResult& result, std::size_t arena_bytes) {
  Json json;
  json["status"] = locate::to_string(result.outcome);
  json["frame"] = loaded.frame_name();
  json["up"] = port::to_string(loaded.scan.up);
  json["up_reason"] = loaded.scan.up_reason;
  json["part"] = part.name.data();
  json["matches"] = Json::array();
  for (const locate::Match& match : result.found()) json["matches"].push_back(json_of(match));
  json["timings_us"] = timings_object(result.timings, loaded.load_us);
  json["search"] = {{"hypotheses", result.hypothesis_count},
                    {"evaluated", result.evaluated_count},
                    {"exact", result.is_exact},
                    {"bound_gap", result.bound_gap}};
  json["memory"] = {{"arena_bytes", arena_bytes}, {"peak_bytes", result.peak_bytes}};
  json["digest"] = formatted("%016llx", static_cast<unsigned long long>(locate::digest(result)));
  return json;
}

}  // namespace flatpose::tool
