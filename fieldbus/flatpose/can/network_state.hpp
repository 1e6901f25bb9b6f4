#pragma once
// The NMT state of a node, and which service each state allows (CiA 301, 7.3.2).
//
//      reset ---> boot-up ---> PRE-OPERATIONAL <---> OPERATIONAL
//                                     ^  \              ^ |
//                                     |   v             | v
//                                     +---- STOPPED ----+
//
// Initialising is left at once, so it has no state here but the boot-up message.

#include <cstdint>

namespace flatpose::can {

/// The numbers are those of the heartbeat.
enum class NetworkState : std::uint8_t { kStopped = 4, kOperational = 5, kPreOperational = 127 };

enum class NetworkCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kEnterPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130,
};

[[nodiscard]] constexpr bool allows_sdo(NetworkState state) noexcept {
  return state != NetworkState::kStopped;
}
/// SYNC and EMCY too are for both states but stopped.
[[nodiscard]] constexpr bool allows_emergency(NetworkState state) noexcept {
  return state != NetworkState::kStopped;
}
[[nodiscard]] constexpr bool allows_pdo(NetworkState state) noexcept {
  return state == NetworkState::kOperational;
}

}  // namespace flatpose::can
