#pragma once
// How sure a pose is, also of another point of the part than its origin: a pick on a long lever is
// less sure than the part itself.

#include <array>

#include "flatpose/locate/locator.hpp"

namespace flatpose::locate {

struct Sigma {
  Vec3 mm;   ///< Of the origin that is told, along the axes of the frame at the face.
  Vec3 rad;  ///< Of the turn, about the axes that are told.
};

/// From the covariance, by rows, of (turn, shift) in the axes `face_R_axes`.
[[nodiscard]] Sigma sigma_of(const Rotation& face_R_axes,
                             const std::array<double, 36>& covariance) noexcept;

/// Of the pose match.face_T_object * object_T_other.  Cost: a microsecond.  Fails: never.
/// About an axis that is free the variance counts as 0: that turn is chosen, not found.
[[nodiscard]] Sigma sigma_of(const Match& match, const Pose& object_T_other) noexcept;

}  // namespace flatpose::locate
