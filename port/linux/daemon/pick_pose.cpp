#include "port/linux/daemon/pick_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flatpose/core/maths.hpp"
#include "flatpose/locate/sigma.hpp"

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

Reported told(const locate::Match& match, const PickPose& pick) noexcept {
  const locate::Sigma sigma = locate::sigma_of(match, pick.object_T_pick);
  Reported out{match.face_T_object * pick.object_T_pick, pick.tool, pick.index, sigma.mm,
               sigma.rad};
  if (match.turn_is_free) out.sigma_rad = without_free_axis(sigma.rad, pick.object_T_pick.rotation);
  return out;
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

std::optional<Reported> report(const locate::Match& match, std::span<const PickPose> picks,
                               const ReportRule& rule, const Frames& frames) noexcept {
  if (rule.kind == PoseKind::kObject) {
    if (!is_inside(rule.limits, match.face_T_object, rule.kind, frames)) return {};
    Reported own{match.face_T_object, 0, 0, match.sigma_mm, match.sigma_rad};
    if (match.turn_is_free) own.sigma_rad = without_free_axis(match.sigma_rad, {});
    return own;
  }
  for (const PickPose& pick : picks) {
    const Pose face_T_pick = match.face_T_object * pick.object_T_pick;
    if (is_inside(rule.limits, face_T_pick, rule.kind, frames)) return told(match, pick);
  }
  return {};
}

}  // namespace flatpose::daemon
