#pragma once
// A thread for what may take its time: it makes room for everything else, and keeps off the
// processors that a search was given.

#include <string>

#include "port/linux/realtime/config.hpp"
#include "port/linux/realtime/step.hpp"

namespace flatpose::port {

/// `name` is what ps and top show (15 characters of it).  Fails: never, see the steps.
[[nodiscard]] Steps set_up_background_thread(const RealtimeConfig& config, const std::string& name);

}  // namespace flatpose::port
