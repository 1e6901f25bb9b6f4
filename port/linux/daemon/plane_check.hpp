#pragma once
// Whether a job's work plane still lies where it was aligned: the plane that a new scan shows
// against the one of the file.

#include <string>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/host.hpp"
#include "flatpose/job/status.hpp"
#include "port/linux/daemon/job_set.hpp"
#include "port/linux/daemon/scan_source.hpp"

namespace flatpose::daemon {

/// What check_plane() takes of an arena for the largest scan.
[[nodiscard]] std::size_t plane_check_bytes(const locate::Limits& limits) noexcept;

/// Until `end_us`, or the host cancels. `told` says in a line what was measured.
/// Answers kOk, kAlignmentMoved, kNoAlignment (the job has no work plane), kScanPoor (no plane is
/// seen), kCancelled, kOutOfTime.  Memory: the arena's, and the line.  Fails: never.
[[nodiscard]] job::Answer check_plane(const Job& job, const HeldScan& scan, Arena arena,
                                      const Host& host, std::int64_t end_us,
                                      std::string& told) noexcept;

}  // namespace flatpose::daemon
