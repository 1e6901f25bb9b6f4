#pragma once
// SIGTERM and SIGINT as something to wait for.

#include <signal.h>

#include <chrono>
#include <optional>

namespace flatpose::daemon {

class StopSignal {
 public:
  /// Blocks the signals for this thread and those it starts: make it first.
  StopSignal() noexcept;
  /// As it was before.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// False when the time is over; without one it waits for ever.
  [[nodiscard]] bool wait_for(std::optional<std::chrono::microseconds> time) noexcept;

 private:
  sigset_t signals_;
  sigset_t before_;
};

}  // namespace flatpose::daemon
