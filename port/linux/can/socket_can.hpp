#pragma once
// A node's end of a SocketCAN interface: the kernel lets through what the node listens to, and says
// what the controller suffers (error frames). Nothing here blocks or gives up: an interface that
// goes down, or away with its adapter, is off until it is back, and may then have become FD or
// classic. Frames bear the time at which they arrived, by the kernel's stamps: the controller's
// own where its driver has some, else those of the interrupt.

#include <cstdint>
#include <string>

#include "flatpose/can/link.hpp"
#include "port/linux/can/arrival_clock.hpp"
#include "port/linux/can/condition.hpp"
#include "port/linux/can/interface.hpp"
#include "port/linux/clock/steady_clock.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::port {

class SocketCan final : public can::Link {
 public:
  /// Listens from now on.  Fails: InputError naming `subject` (see check_can), std::system_error.
  SocketCan(const std::string& subject, const std::string& interface, std::uint8_t node,
            const CanNeed& need);

  [[nodiscard]] bool carries_fd() const noexcept { return carries_fd_; }
  [[nodiscard]] CanCondition condition() const noexcept {
    return {down_count_, off_count_, state_, is_down_, carries_fd_, false};
  }

  /// To wait at: readable when receive() has something.
  [[nodiscard]] int socket() const noexcept { return socket_.get(); }

  /// Cost: a system call.  Call it now and then without reason too: while the interface is off
  /// nothing tells when it is back.
  [[nodiscard]] Received receive() noexcept override;
  [[nodiscard]] bool send(const can::Frame& frame) noexcept override;

 private:
  [[nodiscard]] bool drop_unread() noexcept;
  [[nodiscard]] bool bind_again() noexcept;
  void look_at_clocks() noexcept;
  void go_down() noexcept;
  [[nodiscard]] Received failed(int error) noexcept;
  [[nodiscard]] Received state(can::BusState state) noexcept;
  [[nodiscard]] bool take_error_frame(std::uint32_t classes, std::uint8_t controller) noexcept;

  std::string interface_;
  std::uint8_t node_;
  FileDescriptor socket_;
  SteadyClock clock_;
  ArrivalClock arrival_;
  std::int64_t arrived_us_ = 0;  ///< What was read last; what is told of the bus comes with it.
  can::BusState state_ = can::BusState::kActive;
  bool is_down_ = false;  ///< The interface, or it is gone: `state_` is kOff.
  std::uint16_t down_count_ = 0;
  std::uint16_t off_count_ = 0;
  bool carries_fd_ = false;
  bool is_told_ = false;  ///< That has been received.
  bool has_lost_frames_ = false;
  std::uint32_t drop_count_ = 0;  ///< As the kernel counts them.
};

}  // namespace flatpose::port
