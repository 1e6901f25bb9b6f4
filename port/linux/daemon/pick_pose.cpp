#include "port/linux/daemon/pick_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/sigma.hpp"
#include "flatpose/model/equivalents.hpp"

namespace flatpose::daemon {
namespace {

// A turn about a free axis was chosen, not found: no sigma speaks of it.
Vec3 without_free_axis(Vec3 sigma_rad, const Rotation& object_R_reported) noexcept {
  constexpr double kAlong = 1.0 - 1e-6;
  double* const values[] = {&sigma_rad.x, &sigma_rad.y, &sigma_rad.z};
  for (int i = 0; i < 3; ++i) {
    if (std::fabs(object_R_reported.column(i).z) > kAlong)
      *values[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return sigma_rad;
}

// The part turned into the equivalent that is preferred, then the pick.
Pose object_T_told(const locate::Match& match, const model::Symmetry& symmetry,
                   const Pose& object_T_pick, const ReportRule& rule) noexcept {
  if (!rule.preferred_angle_rad) return object_T_pick;
  return model::told_at_angle(match.face_T_object.rotation, symmetry, object_T_pick,
                              *rule.preferred_angle_rad);
}

}  // namespace

PickPose usual_pick() noexcept { return {Pose{{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, {}}, 1, 0, 0}; }

bool is_inside(const PoseLimits& limits, const Pose& face_T_reported, PoseKind kind,
               const Frames& frames) noexcept {
  const Vec3& p = face_T_reported.position_mm;
  const Vec3& low = limits.least_mm;
  const Vec3& high = limits.greatest_mm;
  const bool is_in_box = p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y &&
                         p.z >= low.z && p.z <= high.z;
  const Rotation work_R_reported = frames.work_T_face().rotation * face_T_reported.rotation;
  const double up = kind == PoseKind::kPick ? -work_R_reported.m[8] : work_R_reported.m[8];
  return is_in_box && arc_cosine(std::clamp(up, -1.0, 1.0)) <= limits.tilt_rad;
}

std::optional<Reported> report(const locate::Match& match, const model::Symmetry& symmetry,
                               std::span<const PickPose> picks, const ReportRule& rule,
                               const Frames& frames) noexcept {
  static constexpr PickPose kOwn{{}, 0, 0, 0};
  if (rule.kind == PoseKind::kObject) picks = {&kOwn, 1};
  for (const PickPose& pick : picks) {
    const Pose object_T_reported = object_T_told(match, symmetry, pick.object_T_pick, rule);
    const Pose face_T_reported = match.face_T_object * object_T_reported;
    if (!is_inside(rule.limits, face_T_reported, rule.kind, frames)) continue;
    const locate::Sigma sigma = locate::sigma_of(match, object_T_reported);
    Reported told{face_T_reported, pick.tool, pick.index, sigma.mm, sigma.rad};
    if (match.turn_is_free)
      told.sigma_rad = without_free_axis(sigma.rad, object_T_reported.rotation);
    return told;
  }
  return {};
}

}  // namespace flatpose::daemon
