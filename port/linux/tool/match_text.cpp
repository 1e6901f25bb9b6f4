#include "port/linux/tool/match_text.hpp"

#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/outcome.hpp"
#include "flatpose/model/equivalents.hpp"
#include "port/linux/tool/match_json.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
Lean lean_of(const Frames& frames, const Pose& face_T_object) noexcept {
  const Rotation work_R_object = frames.work_T_face().rotation * face_T_object.rotation;
  return {arc_cosine(work_R_object.m[8]) * kDegPerRad,
          -model::turn_to_face_x_rad(work_R_object) * kDegPerRad};
}

std::string match_json(const model::Template& part, const LoadedScan& loaded,
                       const locate::LocateResult& result, std::size_t arena_bytes) {
  return line_of(json_of(part, loaded, result, arena_bytes));
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
