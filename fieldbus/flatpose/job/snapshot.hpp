#pragma once
// All that a reader sees at one moment, in one struct: what a response is made from.

#include <array>
#include <cstdint>

#include "flatpose/geometry/robot_convention.hpp"
#include "flatpose/geometry/vec3.hpp"
#include "flatpose/job/command.hpp"
#include "flatpose/job/master.hpp"
#include "flatpose/job/status.hpp"

namespace flatpose::job {

inline constexpr int kFurtherCount = 8;

/// The registers that a master may write, as they stand.
struct CommandImage {
  std::uint16_t command_number = 0;
  std::uint16_t command_session = 0;
  std::uint16_t command = 1;
  std::uint16_t job = 1;
  std::uint16_t pick_number = 0;
  std::uint16_t pick_outcome = 0;
  std::uint16_t control = 0;

  friend bool operator==(const CommandImage&, const CommandImage&) = default;
};

/// A match in the master's numbers.
struct ShownMatch {
  std::uint16_t index = 0;  ///< From 1, best first; 0: no match, and all else means nothing.
  std::uint16_t part = 0;
  Vec3 position_mm;
  std::array<double, 4> rotation{};  ///< In the convention, rad.
  double score = 0.0;
  double visible = 0.0;
  Vec3 sigma_mm;
  Vec3 sigma_rad;
  std::uint16_t tool = 0;
  std::uint16_t pick = 0;
};

struct Snapshot {
  CommandImage image;
  std::uint16_t bits = 0;  ///< Of Bit.
  Answer answer = Answer::kPending;

  std::uint16_t done_number = 0;  ///< 0: there is no result.
  std::uint16_t accepted_number = 0;
  std::uint16_t refused_number = 0;
  Refusal refused_status = Refusal::kNone;
  std::uint16_t scanned_number = 0;
  std::uint16_t cancelled_number = 0;  ///< The command that the last cancel ended.
  std::uint16_t last_number = 0;       ///< The last that was seen from the one who reads.

  std::uint16_t session_id = 0;
  std::uint16_t boot_count = 0;
  std::uint16_t heartbeat = 0;
  std::uint32_t uptime_s = 0;
  Address owner_address = kNobody;
  bool reader_is_owner = false;
  bool result_is_readers = false;  ///< The one who reads asked for this result.
  std::uint32_t answer_by_ms = 0;

  FrameName frame = FrameName::kScan;
  Convention convention = Convention::kKukaAbc;
  std::uint16_t job = 0;
  bool has_scan = false;  ///< Whether the next two mean anything.
  std::uint32_t scan_number = 0;
  std::uint32_t age_ms = 0;  ///< Since the end of acquisition, now.
  std::uint32_t sensor_us = 0;
  std::uint32_t cycle_us = 0;
  std::uint32_t part_hash = 0;
  std::uint32_t alignment_hash = 0;

  std::uint16_t match_count = 0;
  std::uint16_t matches_left = 0;  ///< How often `next` will find one more.
  ShownMatch match;
  std::array<ShownMatch, kFurtherCount> further{};  ///< The ones after it.
};

}  // namespace flatpose::job
