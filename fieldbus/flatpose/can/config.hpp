#pragma once
// What a CAN node is set up with. All else is in its object dictionary.

#include <cstdint>

#include "flatpose/can/frame.hpp"
#include "flatpose/core/status.hpp"

namespace flatpose::can {

inline constexpr int kTextBytesMax = 32;

struct Config {
  std::uint8_t node = 10;  ///< 1 to 127.
  /// The node that commands come from: its address as a master. CAN does not say who sent a
  /// command; the bus has one master. 1 to 127, another than `node`.
  std::uint8_t master = 127;
  std::uint16_t heartbeat_ms = 1000;  ///< Of our own; 0: none. 1017h at start.
  /// The master's heartbeat must come within this, or its command is cancelled; 0: not watched,
  /// then only the lease ends. 1016h at start.
  std::uint16_t master_silence_ms = 0;
  /// Whether the whole result is sent in an FD frame from the start: 2006h:1. Needs `carries_fd`.
  bool fd_frame = false;
  bool fd_bit_rate_switch = true;  ///< Its data at the faster bit rate.
  std::uint16_t fd_frame_id = 0;   ///< Its identifier; 0: 500h + node. See is_fd_report_id().
  bool carries_fd = false;         ///< Whether the link can send FD frames; BusEvent tells anew.
  std::uint32_t serial = 0;        ///< 1018h:4.
  const char* name = "flatpose";   ///< 1008h. Texts are cut at 32 bytes.
  const char* hardware = "-";      ///< 1009h.
  const char* software = "";       ///< 100Ah.
};

[[nodiscard]] constexpr std::uint16_t fd_report_id(const Config& config) noexcept {
  return config.fd_frame_id != 0 ? config.fd_frame_id
                                 : static_cast<std::uint16_t>(kFdReportBase + config.node);
}

/// Fails: kInvalidArgument.
[[nodiscard]] constexpr Status validate(const Config& config) noexcept {
  const auto is_node = [](int node) { return node >= 1 && node <= kNodeMax; };
  const bool is_right =
      is_node(config.node) && is_node(config.master) && config.node != config.master &&
      is_fd_report_id(fd_report_id(config), config.node) && (config.carries_fd || !config.fd_frame);
  return is_right ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace flatpose::can
