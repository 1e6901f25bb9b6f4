#pragma once
// What passes between the job machine and the search: values, so that they may cross threads by any
// mailbox. One order is in force at a time; a newer one, also a stop, replaces it, taken or not. An
// answer bears the ticket of its order: one that comes late is nobody's.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "flatpose/geometry/pose.hpp"
#include "flatpose/job/command.hpp"
#include "flatpose/job/rules.hpp"
#include "flatpose/job/status.hpp"

namespace flatpose::job {

inline constexpr int kMatchesPerScanMax = 32;

struct Order {
  enum class Kind : std::uint8_t { kNone, kStart, kStop };

  Kind kind = Kind::kNone;
  std::uint32_t ticket = 0;
  Command command = Command::kLocate;
  std::uint16_t number = 0;  ///< The master's, for logs and for the camera.
  std::uint16_t job = 0;
  std::uint16_t pick_number = 0;   ///< With kReportPick: the command whose pose was tried.
  std::uint16_t pick_outcome = 0;  ///< With kReportPick, as the master wrote it.
  std::int64_t accepted_us = 0;    ///< Only a scan acquired after this counts.
  std::int64_t answer_by_us = 0;   ///< The moment after which an answer is too late.
};

/// A match as the search found it: best first.
struct FoundMatch {
  Pose frame_T_pick;
  std::uint16_t part = 0;
  double score = 0.0;
  double visible = 0.0;
  Vec3 sigma_mm;   ///< Of the reported origin, along the frame's axes.
  Vec3 sigma_rad;  ///< Of the turn about the reported pose's own axes; NaN about a free one.
  std::uint16_t tool = 0;  ///< That the pose is for; 0: the pose is the object's own.
  std::uint16_t pick = 0;  ///< Which of the part's picks, from 1; 0: none of them.
};

struct ScanResult {
  Answer answer = Answer::kInternal;
  FrameName frame = FrameName::kScan;
  std::uint32_t scan_number = 0;
  std::int64_t acquired_us = 0;  ///< End of acquisition, on the machine's clock.
  bool has_scan = false;         ///< Whether the two before mean anything.
  bool is_simulated = false;
  bool is_repeated = false;  ///< The scan is byte for byte the one before.
  std::uint32_t sensor_us = 0;
  std::uint32_t cycle_us = 0;
  std::uint32_t part_hash = 0;
  std::uint32_t alignment_hash = 0;
  int match_count = 0;
  std::array<FoundMatch, kMatchesPerScanMax> matches{};
};

/// A time as results hold it: the greatest number would say that there is none.
[[nodiscard]] constexpr std::uint32_t held_time(std::int64_t time) noexcept {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(time, 0, kMost));
}

/// What the search tells.
struct SearchEvent {
  enum class Kind : std::uint8_t {
    kSearchAlive,  ///< The search thread went round its loop, or through a stage.
    kSourceAlive,  ///< The scan source showed life; `result.is_simulated` says of what kind it is.
    kSourceGone,   ///< The scan source is known to be dead: READY drops before its silence tells.
    kScanned,      ///< The order's scan is acquired: robot or belt may move.
    kFinished,     ///< The order is done: `result` says how.
  };

  Kind kind = Kind::kSearchAlive;
  std::uint32_t ticket = 0;
  ScanResult result;
};

}  // namespace flatpose::job
