#pragma once
// What the service manager is told, when there is one (systemd's sd_notify).

#include <chrono>
#include <optional>
#include <string>

namespace flatpose::daemon {

/// Each does nothing when no service manager listens.
void tell_ready(const std::string& state);
void tell_alive();
void tell_stopping();

/// How often it wants to hear that the daemon is alive, halved as it advises; none when it does
/// not.
[[nodiscard]] std::optional<std::chrono::microseconds> alive_interval();

}  // namespace flatpose::daemon
