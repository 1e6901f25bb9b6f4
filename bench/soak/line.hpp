#pragma once
// A blocking TCP connection over loopback, and the time of an exchange on it.

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <span>
#include <vector>

#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::soak {

/// On CLOCK_MONOTONIC, as the daemon's records.
[[nodiscard]] inline std::int64_t now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

class Line {
 public:
  /// Fails: std::system_error.
  explicit Line(int port);

  /// Sends, receives as many bytes as `response` has, and returns how long that took.
  /// Fails: std::runtime_error when the other side closes or says nothing for a minute.
  std::int64_t exchange_ns(std::span<const std::uint8_t> request, std::span<std::uint8_t> response);

 private:
  port::FileDescriptor socket_;
};

}  // namespace flatpose::soak
