#pragma once
// From the structs of flatpose.h to the library's own and back.

#include "flatpose/core/status.hpp"
#include "flatpose/flatpose.h"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/geometry/region.hpp"

namespace flatpose::c_api {

[[nodiscard]] inline flatpose_status to_c(Status status) noexcept {
  return static_cast<flatpose_status>(status);
}

[[nodiscard]] inline flatpose_pose to_c(const Pose& pose) noexcept {
  flatpose_pose out;
  for (std::size_t i = 0; i < 9; ++i) out.rotation[i] = pose.rotation.m[i];
  out.position_mm[0] = pose.position_mm.x;
  out.position_mm[1] = pose.position_mm.y;
  out.position_mm[2] = pose.position_mm.z;
  return out;
}

/// A scan where it stands, and the frames that go with it.
struct SeenScan {
  RangeImageView view;
  Frames frames;
  bool is_in_work = false;
};

/// A rotation as a controller may have rounded it becomes one.
/// Fails: kInvalidArgument (no rotation), kNotFinite.
[[nodiscard]] Status from_c(const flatpose_pose& pose, Pose& out) noexcept;
/// Fails: kInvalidArgument, kBadVersion, kNotFinite (a work plane that is no rigid transform).
[[nodiscard]] Status from_c(const flatpose_scan* scan, SeenScan& out) noexcept;
/// Fails: kInvalidArgument.
[[nodiscard]] Status from_c(const flatpose_region& region, Region& out) noexcept;

}  // namespace flatpose::c_api
