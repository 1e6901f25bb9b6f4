#include "bench/scenes/judge.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose::bench {
namespace {

double distance_in_bounds(const PoseError& e, const Bounds& bounds) {
  return std::max({e.position_mm / bounds.position_mm, e.tilt_deg / bounds.tilt_deg,
                   e.turn_deg / bounds.turn_deg});
}

double modulo_symmetry_deg(double turn_deg, int fold) {
  if (fold == 0) return 0.0;
  return std::fabs(std::remainder(turn_deg, 360.0 / fold));
}

}  // namespace

PoseError pose_error(const Pose& scan_T_found, const Pose& scan_T_true, int fold) {
  const Pose true_T_found = scan_T_true.inverse() * scan_T_found;
  const auto& m = true_T_found.rotation.m;
  const Vec3& p_mm = true_T_found.position_mm;
  PoseError e;
  e.position_mm = norm(p_mm);
  e.in_plane_mm = std::hypot(p_mm.x, p_mm.y);
  e.z_mm = std::fabs(p_mm.z);
  e.tilt_deg = std::atan2(std::hypot(m[2], m[5]), m[8]) * kDegPerRad;
  // The turn about z that is left when the shortest rotation has laid the z axes together.
  e.turn_deg = modulo_symmetry_deg(std::atan2(m[3] - m[1], m[0] + m[4]) * kDegPerRad, fold);
  return e;
}

bool is_within(const PoseError& error, const Bounds& bounds) {
  return distance_in_bounds(error, bounds) <= 1.0;
}

Nearest nearest(const Pose& scan_T_found, std::span<const Truth> truths, int fold) {
  Nearest best;
  for (int i = 0; i < static_cast<int>(truths.size()); ++i) {
    const PoseError error = pose_error(scan_T_found, truths[i].scan_T_part, fold);
    if (best.instance &&
        distance_in_bounds(error, kCoarse) >= distance_in_bounds(best.error, kCoarse))
      continue;
    best = {i, error};
  }
  return best;
}

FirstVerdict judge_first(std::span<const Pose> scan_T_found, std::span<const Truth> truths,
                         int fold) {
  FirstVerdict verdict;
  verdict.has_target = std::any_of(truths.begin(), truths.end(), [](const Truth& truth) {
    return truth.visible >= kVisibleOfTarget;
  });
  verdict.has_answer = !scan_T_found.empty();
  if (!verdict.has_answer) return verdict;
  verdict.nearest = nearest(scan_T_found.front(), truths, fold);
  if (!verdict.nearest.instance || truths[*verdict.nearest.instance].visible < kVisibleOfTarget)
    return verdict;
  verdict.is_coarse = is_within(verdict.nearest.error, kCoarse);
  verdict.is_fine = is_within(verdict.nearest.error, kFine);
  return verdict;
}

AllVerdict judge_all(std::span<const Pose> scan_T_found, std::span<const Truth> truths, int fold,
                     int max_matches) {
  AllVerdict verdict;
  std::vector<bool> is_found(truths.size(), false);
  for (int i = 0; i < static_cast<int>(scan_T_found.size()); ++i) {
    const Nearest near = nearest(scan_T_found[i], truths, fold);
    if (!near.instance || !is_within(near.error, kCoarse)) {
      verdict.wrong_matches.push_back(i);
    } else if (is_found[*near.instance]) {
      verdict.double_matches.push_back(i);
    } else {
      is_found[*near.instance] = true;
    }
  }
  for (int i = 0; i < static_cast<int>(truths.size()); ++i) {
    if (truths[i].visible < kVisibleOfWanted) continue;
    ++verdict.wanted_count;
    if (is_found[i]) {
      ++verdict.found_count;
    } else {
      verdict.missed.push_back(i);
    }
  }
  verdict.wanted_count = std::min(verdict.wanted_count, max_matches);
  if (verdict.found_count >= verdict.wanted_count) verdict.missed.clear();
  return verdict;
}

}  // namespace flatpose::bench
