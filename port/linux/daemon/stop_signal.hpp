#pragma once
// SIGTERM, SIGINT and SIGHUP as something to wait for.

#include <signal.h>

#include <chrono>
#include <optional>

namespace flatpose::daemon {

enum class Signal { kNone, kStop, kReload };

class StopSignal {
 public:
  /// Blocks the signals for this thread and those it starts: make it first.
  StopSignal() noexcept;
  /// As it was before.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// kNone when the time is over; without one it waits for ever.
  [[nodiscard]] Signal wait_for(std::optional<std::chrono::microseconds> time) noexcept;

 private:
  sigset_t signals_;
  sigset_t before_;
};

}  // namespace flatpose::daemon
