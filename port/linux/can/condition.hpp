#pragma once
// How the node and its interface are, as the bus's thread sees it, small enough to be passed to
// another thread whole. What was over before anybody looked is in the counts.

#include <cstdint>

#include "flatpose/can/device.hpp"

namespace flatpose::port {

struct alignas(8) CanCondition {
  std::uint16_t down_count = 0;  ///< How often it went down, or away, since the start.
  std::uint16_t off_count = 0;   ///< How often it was bus-off.
  can::BusState bus = can::BusState::kActive;
  bool is_down = false;  ///< Or gone: then `bus` is kOff.
  bool carries_fd = false;
  bool has_twin = false;  ///< Another node of the same number was heard.

  friend bool operator==(const CanCondition&, const CanCondition&) = default;
};

}  // namespace flatpose::port
