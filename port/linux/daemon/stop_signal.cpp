#include "port/linux/daemon/stop_signal.hpp"

#include <pthread.h>

#include <ctime>

namespace flatpose::daemon {

StopSignal::StopSignal() noexcept {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

StopSignal::~StopSignal() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

Signal StopSignal::wait_for(std::optional<std::chrono::microseconds> time) noexcept {
  constexpr std::int64_t kUsPerS = 1'000'000;
  timespec limit{};
  if (time) limit = {time->count() / kUsPerS, 1000 * (time->count() % kUsPerS)};
  // Another signal that is handled ends the wait early; the caller comes back.
  const int signal = sigtimedwait(&signals_, nullptr, time ? &limit : nullptr);
  if (signal <= 0) return Signal::kNone;
  return signal == SIGHUP ? Signal::kReload : Signal::kStop;
}

}  // namespace flatpose::daemon
