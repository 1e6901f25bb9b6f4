#pragma once
// Found poses held against the truth. A part with an N-fold symmetry looks alike after a turn by
// 360 / N degrees about its z axis; such poses are the same to the judge.
//
//   right    within the coarse bounds of an instance
//   fine     within the fine bounds
//   wrong    within the coarse bounds of no instance, however little of it is visible
//   double   on an instance that a better match took already

#include <optional>
#include <span>
#include <vector>

#include "flatpose/geometry/pose.hpp"

namespace flatpose::bench {

inline constexpr double kVisibleOfTarget = 0.5;  ///< An answer must be on one visible this much.
inline constexpr double kVisibleOfWanted = 0.6;  ///< Of several, those that must be found.

struct Bounds {
  double position_mm;
  double tilt_deg;
  double turn_deg;
};
inline constexpr Bounds kCoarse{5.0, 10.0, 5.0};
inline constexpr Bounds kFine{1.0, 1.0, 1.0};

struct PoseError {
  double position_mm = 0.0;  ///< Distance of the origins,
  double in_plane_mm = 0.0;  ///< its share in the true top plane,
  double z_mm = 0.0;         ///< and out of it.
  double tilt_deg = 0.0;     ///< Angle between the z axes.
  double turn_deg = 0.0;     ///< About z, to the nearest equivalent pose.
};

/// `fold` as the simulator has it: turns that leave the part as it is; 0: every turn.
[[nodiscard]] PoseError pose_error(const Pose& scan_T_found, const Pose& scan_T_true, int fold);
[[nodiscard]] bool is_within(const PoseError& error, const Bounds& bounds);

/// An instance of the part that is looked for.
struct Truth {
  Pose scan_T_part;
  double visible = 0.0;
};

/// A found pose and the instance it is nearest to, in units of the coarse bounds.
struct Nearest {
  std::optional<int> instance;  ///< None when there is no instance at all.
  PoseError error;
};
[[nodiscard]] Nearest nearest(const Pose& scan_T_found, std::span<const Truth> truths, int fold);

/// The verdict on the best match.
struct FirstVerdict {
  bool has_target = false;  ///< Whether an instance is visible enough to be asked for.
  bool has_answer = false;
  bool is_coarse = false;  ///< Right, on an instance visible enough.
  bool is_fine = false;
  Nearest nearest;
};
[[nodiscard]] FirstVerdict judge_first(std::span<const Pose> scan_T_found,
                                       std::span<const Truth> truths, int fold);

/// The verdict on all matches.
struct AllVerdict {
  int wanted_count = 0;             ///< Instances visible enough, as many as may be reported,
  int found_count = 0;              ///< how many of them a match is right on,
  std::vector<int> missed;          ///< and those of which too few were found.
  std::vector<int> wrong_matches;   ///< Places in the order of the matches.
  std::vector<int> double_matches;  ///< Likewise.
};
/// `max_matches` as it was asked for: of 35 instances 20 matches can be right on 20.
[[nodiscard]] AllVerdict judge_all(std::span<const Pose> scan_T_found,
                                   std::span<const Truth> truths, int fold, int max_matches);

}  // namespace flatpose::bench
