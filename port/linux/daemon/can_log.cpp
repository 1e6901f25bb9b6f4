#include "port/linux/daemon/can_log.hpp"

#include <algorithm>

namespace flatpose::daemon {
namespace {

using can::BusState;

std::string times(int before, int now) {
  const int count = static_cast<std::uint16_t>(now - before);
  return count > 1 ? " " + std::to_string(count) + " times" : "";
}

}  // namespace

std::vector<std::string> CanLog::lines(std::int64_t now_us, const port::CanCondition& fresh,
                                       bool is_there) {
  std::vector<std::string> said;
  if (!may_speak(now_us, !(fresh == said_))) return said;
  if (fresh.has_twin && !said_.has_twin)
    said.push_back("warning: another node " + std::to_string(node_) + " is on " + interface_ +
                   ": give one of them another number");
  for (std::string line : {of_interface(fresh, is_there), of_bus(fresh)})
    if (!line.empty()) said.push_back(std::move(line));
  said_ = fresh;
  return said;
}

// What is steady for as long as the pause lasted is spoken of at once the next time.
bool CanLog::may_speak(std::int64_t now_us, bool is_new) noexcept {
  if (now_us < silent_until_us_) return false;
  if (now_us - silent_until_us_ > pause_us_) pause_us_ = kPause_us;
  if (!is_new) return false;
  silent_until_us_ = now_us + pause_us_;
  pause_us_ = std::min(2 * pause_us_, kPauseMost_us);
  return true;
}

std::string CanLog::of_interface(const port::CanCondition& fresh, bool is_there) const {
  const bool was_down = said_.is_down || fresh.down_count != said_.down_count;
  if (fresh.is_down) {
    if (said_.is_down && fresh.down_count == said_.down_count) return {};
    return "warning: " + interface_ + (is_there ? " is down" : " is gone") +
           ": the CAN node waits for it";
  }
  std::string line;
  if (was_down)
    line = said_.is_down ? interface_ + " is back"
                         : interface_ + " was down" + times(said_.down_count, fresh.down_count) +
                               " and is back";
  if (fresh.carries_fd == said_.carries_fd) return line;
  if (line.empty()) line = interface_ + " has changed";
  return line + (fresh.carries_fd ? ": it carries FD frames now"
                                  : ": it is classic now, the FD frame stays out");
}

std::string CanLog::of_bus(const port::CanCondition& fresh) const {
  if (fresh.is_down) return {};
  const bool was_off_meanwhile = fresh.off_count != said_.off_count;
  const bool was_off = said_.bus == BusState::kOff && !said_.is_down;
  const std::string count = times(said_.off_count, fresh.off_count);
  if (fresh.bus == BusState::kOff && (was_off_meanwhile || !was_off))
    return "warning: " + interface_ + " is bus-off" + (count.empty() ? "" : ", it was" + count) +
           ": see wiring, termination and bit rates; the CAN node waits until the controller is "
           "restarted (restart-ms, or ip link set " +
           interface_ + " type can restart)";
  if (fresh.bus == BusState::kOff) return {};
  if (was_off_meanwhile && !was_off)
    return "warning: " + interface_ + " was bus-off" + count + " and is restarted";
  if (was_off) return interface_ + " is restarted";
  if (fresh.bus == said_.bus || said_.is_down) return {};
  if (fresh.bus == BusState::kErrorPassive)
    return "warning: " + interface_ +
           " is error passive: frames fail; see wiring, termination and bit rates, and whether "
           "anybody else is on the bus";
  return interface_ + " is error active again";
}

}  // namespace flatpose::daemon
