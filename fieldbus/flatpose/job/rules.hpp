#pragma once
// What the job machine is set up with: how masters are treated, and what it must know of each job.

#include <array>
#include <cstdint>

#include "flatpose/core/status.hpp"
#include "flatpose/geometry/robot_convention.hpp"
#include "flatpose/job/command.hpp"

namespace flatpose::job {

inline constexpr int kJobCountMax = 64;

enum class Handshake : std::uint8_t { kNumber, kBits };

struct Config {
  std::uint16_t session_id = 1;  ///< Random at each start, not 0.
  std::uint16_t boot_count = 0;
  Handshake handshake = Handshake::kNumber;
  bool allow_simulated = false;       ///< Whether a simulated scan may make a pose.
  std::int64_t lease_us = 5'000'000;  ///< An owner silent for longer is none; 0.1 s to 1 h.
  /// Search and scan source must have shown life within this, or READY drops; 0.1 s to 1 h.
  std::int64_t liveness_limit_us = 2'000'000;
};

struct JobRule {
  std::uint16_t job = 1;               ///< Not 0.
  FrameName frame = FrameName::kScan;  ///< A result in another frame is a fault.
  Convention convention = Convention::kKukaAbc;
  bool has_reference = false;              ///< Whether rotations stay near `reference`.
  std::array<double, 4> reference{};       ///< In the convention's numbers, rad.
  std::int64_t max_age_us = 0;             ///< An older pose is expired; 0: none is.
  std::int64_t answer_by_us = 10'000'000;  ///< After acceptance, in any case; 1 ms to 1 h.
};

/// The jobs that there are. Taken over whole, or not at all.
struct JobTable {
  std::array<JobRule, kJobCountMax> rules{};
  int count = 0;

  [[nodiscard]] const JobRule* find(std::uint16_t job) const noexcept {
    for (int i = 0; i < count; ++i) {
      if (rules[i].job == job) return &rules[i];
    }
    return nullptr;
  }
};

/// Fails: kInvalidArgument.
[[nodiscard]] Status validate(const Config& config) noexcept;
/// Fails: kInvalidArgument (a number out of its range, a job twice), kNotFinite (a reference).
[[nodiscard]] Status validate(const JobTable& jobs) noexcept;

}  // namespace flatpose::job
