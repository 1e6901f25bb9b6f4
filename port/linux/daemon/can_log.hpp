#pragma once
// What the log says of the CAN interface: a line when it goes down and when it is back, and so on.
// One that changes all the time, as in bus-off with restart-ms, is spoken of less and less often,
// with how often it was.

#include <cstdint>
#include <string>
#include <vector>

#include "port/linux/can/condition.hpp"

namespace flatpose::daemon {

class CanLog {
 public:
  /// Nothing is between two lines for less than this at first, then for twice as long, and so on.
  static constexpr std::int64_t kPause_us = 1'000'000;
  static constexpr std::int64_t kPauseMost_us = 64'000'000;

  /// `start` is what the start has told already.
  CanLog(std::string interface, int node, const port::CanCondition& start)
      : interface_(std::move(interface)), node_(node), said_(start) {}

  /// What is to be said now, if anything.  `is_there`: an interface of that name is, up or not.
  [[nodiscard]] std::vector<std::string> lines(std::int64_t now_us, const port::CanCondition& fresh,
                                               bool is_there);

 private:
  [[nodiscard]] bool may_speak(std::int64_t now_us, bool is_new) noexcept;
  [[nodiscard]] std::string of_interface(const port::CanCondition& fresh, bool is_there) const;
  [[nodiscard]] std::string of_bus(const port::CanCondition& fresh) const;

  std::string interface_;
  int node_;
  port::CanCondition said_;
  std::int64_t silent_until_us_ = 0;
  std::int64_t pause_us_ = kPause_us;
};

}  // namespace flatpose::daemon
