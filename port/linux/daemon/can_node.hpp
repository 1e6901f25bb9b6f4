#pragma once
// The node on its CAN interface, for the bus's thread.

#include <string>

#include "flatpose/can/station.hpp"
#include "port/linux/can/socket_can.hpp"
#include "port/linux/daemon/config.hpp"

namespace flatpose::daemon {

class CanNode {
 public:
  /// Refers to the machine, which must outlive it.
  /// Fails: port::InputError naming the line of the config, std::system_error.
  CanNode(const CanConfig& config, job::Machine& machine, std::int64_t now_us);

  [[nodiscard]] can::Station& station() noexcept { return station_; }
  [[nodiscard]] const can::Station& station() const noexcept { return station_; }
  /// To wait at.
  [[nodiscard]] int socket() const noexcept { return link_.socket(); }
  /// "CANopen node 10 on can0 at 250 kbit/s"
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// What the config asks for and nobody can check; empty: nothing.
  [[nodiscard]] const std::string& doubt() const noexcept { return doubt_; }
  [[nodiscard]] port::CanCondition condition() const noexcept {
    port::CanCondition found = link_.condition();
    found.has_twin = device_.has_twin();
    return found;
  }

 private:
  port::SocketCan link_;
  can::Device device_;
  can::Station station_;
  std::string name_;
  std::string doubt_;
};

}  // namespace flatpose::daemon
