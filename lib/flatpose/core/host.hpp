#pragma once
// What lib asks of whoever runs it: the time, hands to share the work out to, and whether to stop.

#include "flatpose/core/cancel.hpp"
#include "flatpose/core/clock.hpp"
#include "flatpose/core/executor.hpp"

namespace flatpose {

/// Refers to what it is made from, which must outlive it.
struct Host {
  /// A clock alone: all is done on the caller's thread.
  Host(const Clock& host_clock) noexcept : clock(host_clock) {}  // NOLINT: a clock is a host
  Host(const Clock& host_clock, Executor& host_executor,
       const Cancel* host_cancel = nullptr) noexcept
      : clock(host_clock), executor(host_executor), cancel(host_cancel) {}

  const Clock& clock;
  Executor& executor = callers_thread;
  /// When it asks, a run ends as soon as it would at a deadline; null: never.
  const Cancel* cancel = nullptr;
};

}  // namespace flatpose
