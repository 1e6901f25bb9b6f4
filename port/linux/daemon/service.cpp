#include "port/linux/daemon/service.hpp"

#include <systemd/sd-daemon.h>

namespace flatpose::daemon {

void tell_ready(const std::string& state) { sd_notifyf(0, "READY=1\nSTATUS=%s", state.c_str()); }

void tell_alive() { sd_notify(0, "WATCHDOG=1"); }

void tell_stopping() { sd_notify(0, "STOPPING=1"); }

std::optional<std::chrono::microseconds> alive_interval() {
  std::uint64_t timeout_us = 0;
  if (sd_watchdog_enabled(0, &timeout_us) <= 0 || timeout_us < 2) return std::nullopt;
  return std::chrono::microseconds(timeout_us / 2);
}

}  // namespace flatpose::daemon
