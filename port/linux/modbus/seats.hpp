#pragma once
// Who has to leave when all seats are taken and another client knocks: first whoever never sent a
// whole frame, the longest there of them; then the one silent for longest, if it is idle; never the
// connection that the owner speaks on. Else nobody, and the newcomer is turned away.

#include <cstdint>
#include <span>

#include "flatpose/job/master.hpp"

namespace flatpose::port {

struct Seat {
  bool is_taken = false;
  bool has_sent_a_frame = false;
  job::Address address = job::kNobody;
  std::int64_t heard_us = 0;  ///< The last whole frame; before that, the connection.
};

/// Silent for so long a connection is idle.
inline constexpr std::int64_t kIdle_us = 5'000'000;

/// A seat that is free or to be freed; -1: none. Of several connections of the owner the one heard
/// last is kept: so a master that never closes any cannot lock itself out.
[[nodiscard]] int seat_for_newcomer(std::span<const Seat> seats, job::Address owner,
                                    std::int64_t now_us) noexcept;

}  // namespace flatpose::port
