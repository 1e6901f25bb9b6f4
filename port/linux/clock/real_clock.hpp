#pragma once
// The machine's real-time clock, which files and frames are stamped by: anybody may set it.

#include <cstdint>
#include <ctime>

namespace flatpose::port {

[[nodiscard]] constexpr std::int64_t us_of(std::int64_t seconds,
                                           std::int64_t nanoseconds) noexcept {
  return seconds * 1'000'000 + nanoseconds / 1000;
}

/// Since 1970.
[[nodiscard]] inline std::int64_t real_now_us() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return us_of(now.tv_sec, now.tv_nsec);
}

}  // namespace flatpose::port
