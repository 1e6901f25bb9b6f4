#pragma once
// What lib asks of whoever runs it: the time, and hands to share the work out to.

#include "flatpose/core/clock.hpp"
#include "flatpose/core/executor.hpp"

namespace flatpose {

/// Refers to what it is made from, which must outlive it.
struct Host {
  /// A clock alone: all is done on the caller's thread.
  Host(const Clock& host_clock) noexcept : clock(host_clock) {}  // NOLINT: a clock is a host
  Host(const Clock& host_clock, Executor& host_executor) noexcept
      : clock(host_clock), executor(host_executor) {}

  const Clock& clock;
  Executor& executor = callers_thread;
};

}  // namespace flatpose
