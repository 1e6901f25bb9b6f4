#pragma once
// What of a match is told: the part's own pose, or where a tool is to go. A pick's z is the tool's:
// it points into the surface.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flatpose/geometry/frames.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/model/template.hpp"

namespace flatpose::daemon {

/// [[part.pick]]
struct PickPose {
  Pose object_T_pick;
  std::uint16_t tool = 1;
  std::int64_t priority = 0;  ///< The highest that lies inside the job's limits is told.
  std::uint16_t index = 0;    ///< Of the part's, from 1; 0: the usual pick of a part without any.
};

/// At the object's origin, z into the surface: the object turned by 180 degrees about its x.
[[nodiscard]] PickPose usual_pick() noexcept;

enum class PoseKind : std::uint8_t { kObject, kPick };

/// What withholds a pose that was found, in the job's frame.
struct PoseLimits {
  Vec3 least_mm{-1e9, -1e9, -1e9};
  Vec3 greatest_mm{1e9, 1e9, 1e9};
  /// Of the object's z against the plane's, or of the tool's against straight down.
  double tilt_rad = 10.0;

  friend bool operator==(const PoseLimits&, const PoseLimits&) = default;
};

[[nodiscard]] bool is_inside(const PoseLimits& limits, const Pose& face_T_reported, PoseKind kind,
                             const Frames& frames) noexcept;

/// A match as it is told.
struct Reported {
  Pose face_T_reported;
  std::uint16_t tool = 0;
  std::uint16_t pick = 0;
  Vec3 sigma_mm;
  Vec3 sigma_rad;  ///< NaN about a free axis.
};

/// What a job says of how matches are told.
struct ReportRule {
  PoseKind kind = PoseKind::kObject;
  PoseLimits limits;
  /// Of a symmetric part the equivalent is told whose x stands nearest to this, in the frame's xy
  /// plane; none: the one that the search gave.
  std::optional<double> preferred_angle_rad{};
};

/// The part's own pose, or of `picks`, which are in the order of their priority, the first; inside
/// the limits.  None: all are outside.  Cost: microseconds a pick.  Memory: none.
[[nodiscard]] std::optional<Reported> report(const locate::Match& match,
                                             const model::Symmetry& symmetry,
                                             std::span<const PickPose> picks,
                                             const ReportRule& rule, const Frames& frames) noexcept;

}  // namespace flatpose::daemon
