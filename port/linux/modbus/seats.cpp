#include "port/linux/modbus/seats.hpp"

namespace flatpose::port {
namespace {

/// The seat heard longest ago of those that `may_go`; -1: none.
template <class MayGo>
int oldest(std::span<const Seat> seats, const MayGo& may_go) noexcept {
  int found = -1;
  for (int i = 0; i < static_cast<int>(seats.size()); ++i) {
    if (!may_go(i)) continue;
    if (found < 0 || seats[i].heard_us < seats[found].heard_us) found = i;
  }
  return found;
}

int kept_for(job::Address owner, std::span<const Seat> seats) noexcept {
  int kept = -1;
  for (int i = 0; i < static_cast<int>(seats.size()); ++i) {
    if (owner == job::kNobody || seats[i].address != owner || !seats[i].has_sent_a_frame) continue;
    if (kept < 0 || seats[i].heard_us >= seats[kept].heard_us) kept = i;
  }
  return kept;
}

}  // namespace

int seat_for_newcomer(std::span<const Seat> seats, job::Address owner,
                      std::int64_t now_us) noexcept {
  for (int i = 0; i < static_cast<int>(seats.size()); ++i) {
    if (!seats[i].is_taken) return i;
  }
  const int kept = kept_for(owner, seats);
  const int mute = oldest(seats, [&](int i) { return i != kept && !seats[i].has_sent_a_frame; });
  if (mute >= 0) return mute;
  return oldest(seats, [&](int i) { return i != kept && now_us - seats[i].heard_us >= kIdle_us; });
}

}  // namespace flatpose::port
