#pragma once
// What a camera driver answers with: nothing of it is believed before it was looked at. Its points
// are copied first and judged in the copy, because the driver may still write where they stand.

#include <cstddef>
#include <span>
#include <string>

#include "flatpose/camera_protocol.h"
#include "flatpose/locate/locator.hpp"
#include "port/linux/daemon/scan_handover.hpp"

namespace flatpose::daemon {

/// What memory a driver is given: points of 16 bytes fit too.
[[nodiscard]] std::size_t driver_memory_bytes(const locate::Limits& limits) noexcept;

/// What is wrong with the answer; empty: nothing. Every place it names lies in the memory then.
[[nodiscard]] std::string fault_of(const flatpose_camera_done_message& done,
                                   std::size_t memory_bytes, const locate::Limits& limits,
                                   const ScanOrder& order, std::int64_t now_us);

/// Copies the points of an answer without fault into the blank, and tells whether they are the last
/// ones again.  Cost: one pass.  Returns what is wrong with the points; empty: nothing.
[[nodiscard]] std::string copy_points(const flatpose_camera_done_message& done,
                                      std::span<const std::byte> memory,
                                      const ScanHandover::Blank& blank);

}  // namespace flatpose::daemon
