#pragma once
// Sets the calling thread up: its processor, its stack, its timers, its priority.

#include <string>

#include "port/linux/realtime/config.hpp"
#include "port/linux/realtime/step.hpp"

namespace flatpose::port {

/// Touched beforehand on every thread that searches; holds the library's deepest call many times.
inline constexpr std::size_t kStackTouched_bytes = 512 * 1024;

/// `index` is the thread's number in its search, 0 for the one that calls the library; `name` is
/// what ps and top show (15 characters of it) and the steps begin with.
/// Only what the config asks for is a step.  Fails: never, see the steps.
[[nodiscard]] Steps set_up_this_thread(const RealtimeConfig& config, int index,
                                       const std::string& name);

}  // namespace flatpose::port
