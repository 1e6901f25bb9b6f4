#pragma once
// A well-behaved PLC: writes a number, reads the result block until the number is done, and holds
// each answer against the one before: no number is lost, none executed twice.

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "bench/soak/line.hpp"
#include "flatpose/result_map/table.hpp"

namespace flatpose::soak {

inline constexpr std::size_t kReadBytes = 12;
inline constexpr std::size_t kBlockBytes = 9 + 2 * result_map::kResultWords;

struct Plan {
  int port = 0;
  int echo_port = 0;
  std::int64_t trigger_count = 0;
  std::int64_t time_max_us = 0;  ///< No new trigger after it; 0: none.
  std::int64_t poll_us = 500;    ///< Between two reads.
  std::int64_t pause_us = 0;     ///< Between an answer and the next trigger.
  std::uint16_t first_number = 1;
};

/// One trigger's way, on the steady clock.
struct Trip {
  std::uint16_t number = 0;
  std::int64_t written_us = 0;  ///< The write was sent.
  std::int64_t read_us = 0;     ///< The read that showed it done was there.
  int status = 0;
};

struct Tally {
  std::int64_t done_count = 0;
  std::int64_t refused_count = 0;
  std::int64_t lost_count = 0;     ///< No answer within a minute.
  std::int64_t doubled_count = 0;  ///< More scans were taken than numbers accepted.
  std::int64_t torn_count = 0;     ///< Blocks whose head and tail differ.
  std::map<int, std::int64_t> statuses;
  std::vector<std::int64_t> read_ns;
  std::vector<std::int64_t> write_ns;
  std::vector<std::int64_t> echo_ns;
  std::vector<Trip> trips;
};

/// Fails: std::exception when it can go on no more.
[[nodiscard]] Tally run_plc(const Plan& plan);

}  // namespace flatpose::soak
