#pragma once
// Which of a symmetric part's equivalent poses is reported: the one with the smallest turn from
// object x to the face's x, or the one that stands as a user prefers.

#include "flatpose/geometry/pose.hpp"
#include "flatpose/model/template.hpp"

namespace flatpose::model {

/// The pose turned by `angle_rad` about the part's axis of symmetry.
[[nodiscard]] Pose turned_about_symmetry(const Pose& face_T_object, const Symmetry& symmetry,
                                         double angle_rad) noexcept;

/// The turn about object z that would lay object x onto the face's x; 0 when the face's x stands on
/// the surface.
[[nodiscard]] double turn_to_face_x_rad(const Rotation& face_R_object) noexcept;

/// The equivalent pose whose object x is turned least from the face's x. Unchanged for a part
/// without symmetry.
[[nodiscard]] Pose canonical_equivalent(const Pose& face_T_object,
                                        const Symmetry& symmetry) noexcept;

/// The turn about the axis of symmetry after which the x axis of `object_R_told`, seen in the
/// face's xy plane, stands nearest to `angle_rad` (from the face's x to its y): of N equivalents,
/// or, with full symmetry, of all turns: exactly there, where there is such a turn.  0 without
/// symmetry. Cost: linear in the order.
[[nodiscard]] double turn_to_angle_rad(const Rotation& face_R_object, const Symmetry& symmetry,
                                       const Rotation& object_R_told, double angle_rad) noexcept;

/// `object_T_told` on the equivalent that turn_to_angle_rad() prefers, seen from the object as it
/// was found.
[[nodiscard]] Pose told_at_angle(const Rotation& face_R_object, const Symmetry& symmetry,
                                 const Pose& object_T_told, double angle_rad) noexcept;

}  // namespace flatpose::model
