#pragma once
// The frames that a scan passes through: scan (as the sensor gave it), work (z up, where height
// maps live) and the face (what the user's coordinates and poses are in: scan, or work when the
// user has aligned one).

#include "flatpose/geometry/pose.hpp"

namespace flatpose {

struct Frames {
  Pose work_T_scan;
  Pose face_T_work;

  [[nodiscard]] Pose work_T_face() const noexcept { return face_T_work.inverse(); }
};

/// No alignment: the face is the scan; work is the scan with z turned up (about x, so that x stays)
/// when it looks down.
[[nodiscard]] inline Frames frames_of_scan(bool up_is_plus_z) noexcept {
  if (up_is_plus_z) return {};
  const Pose flip{{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, {}};
  return {flip, flip};
}

/// An aligned work plane: the face is work itself.
[[nodiscard]] inline Frames frames_of_work(const Pose& work_T_scan) noexcept {
  return {work_T_scan, {}};
}

}  // namespace flatpose
