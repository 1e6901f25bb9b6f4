#include "port/linux/tool/match_text.hpp"

#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/outcome.hpp"
#include "flatpose/model/equivalents.hpp"
#include "port/linux/tool/number_text.hpp"
#include "port/linux/tool/pose_json.hpp"

namespace flatpose::tool {
namespace {

Json match_object(const locate::Match& match) {
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

Lean lean_of(const Frames& frames, const Pose& face_T_object) noexcept {
  const Rotation work_R_object = frames.work_T_face().rotation * face_T_object.rotation;
  return {arc_cosine(work_R_object.m[8]) * kDegPerRad,
          -model::turn_to_face_x_rad(work_R_object) * kDegPerRad};
}

std::string match_json(const model::Template& part, const LoadedScan& loaded,
                       const locate::LocateResult& result, std::size_t arena_bytes) {
  Json json;
  json["status"] = locate::to_string(result.outcome);
  json["frame"] = loaded.frame_name();
  json["up"] = port::to_string(loaded.scan.up);
  json["up_reason"] = loaded.scan.up_reason;
  json["part"] = part.name.data();
  json["matches"] = Json::array();
  for (const locate::Match& match : result.found()) json["matches"].push_back(match_object(match));
  json["timings_us"] = timings_object(result.timings, loaded.load_us);
  json["search"] = {{"hypotheses", result.hypothesis_count},
                    {"evaluated", result.evaluated_count},
                    {"exact", result.is_exact},
                    {"bound_gap", result.bound_gap}};
  json["memory"] = {{"arena_bytes", arena_bytes}, {"peak_bytes", result.peak_bytes}};
  json["digest"] = formatted("%016llx", static_cast<unsigned long long>(locate::digest(result)));
  return line_of(json);
}

std::string match_table(const model::Template& part, const LoadedScan& loaded,
                        const locate::LocateResult& result) {
  std::string text = formatted(
      "%s: %d of part '%s' in %s (%.1f ms; frame %s, up %s by %s)\n",
      locate::to_string(result.outcome), result.match_count, part.name.data(), loaded.path.c_str(),
      static_cast<double>(result.timings.total_us) / 1000.0, loaded.frame_name(),
      port::to_string(loaded.scan.up), loaded.scan.up_reason.c_str());
  if (result.match_count == 0)
    return text + formatted("best that was refused: score %.2f, threshold %.2f\n",
                            result.best_rejected_score, part.score_threshold);
  text +=
      "   #  score  visible      x mm       y mm       z mm   tilt    turn deg"
      "   sigma x y z mm       turn deg\n";
  int number = 0;
  for (const locate::Match& match : result.found()) {
    const Vec3& p = match.face_T_object.position_mm;
    const Lean lean = lean_of(loaded.frames, match.face_T_object);
    const std::string turn = match.turn_is_free ? "any" : formatted("%8.3f", lean.turn_deg);
    const std::string turn_sigma =
        match.turn_is_free ? "-" : formatted("%.3f", match.sigma_rad.z * kDegPerRad);
    text +=
        formatted("%4d  %5.3f  %7.3f  %9.3f  %9.3f  %9.3f  %5.2f  %10s   %.3f %.3f %.3f    %s\n",
                  ++number, match.score, match.visible, p.x, p.y, p.z, lean.tilt_deg, turn.c_str(),
                  match.sigma_mm.x, match.sigma_mm.y, match.sigma_mm.z, turn_sigma.c_str());
  }
  return text;
}

}  // namespace flatpose::tool
