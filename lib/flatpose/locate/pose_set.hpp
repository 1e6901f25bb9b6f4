#pragma once
// Poses to which others are compared: from where a refinement started and where it ended, so that
// none is done twice.

#include <span>

#include "flatpose/geometry/pose.hpp"

namespace flatpose::locate {

class PoseSet {
 public:
  PoseSet() noexcept = default;
  /// In memory that the caller keeps. Poses nearer than both bounds count as one.
  PoseSet(std::span<Pose> memory, double near_mm, double near_rad) noexcept
      : memory_(memory), near_mm_(near_mm), near_rad_(near_rad) {}

  /// What there is no room for is forgotten.
  void add(const Pose& pose) noexcept {
    if (count_ < static_cast<int>(memory_.size())) memory_[count_++] = pose;
  }
  [[nodiscard]] bool contains(const Pose& pose) const noexcept {
    for (const Pose& other : memory_.first(static_cast<std::size_t>(count_))) {
      if (norm(other.position_mm - pose.position_mm) < near_mm_ &&
          angle_between_rad(other.rotation, pose.rotation) < near_rad_)
        return true;
    }
    return false;
  }

 private:
  std::span<Pose> memory_;
  double near_mm_ = 0.0;
  double near_rad_ = 0.0;
  int count_ = 0;
};

}  // namespace flatpose::locate
