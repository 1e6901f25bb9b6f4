#pragma once
// What carries frames: SocketCAN in the product, a simulated bus in tests.

#include <cstdint>

#include "flatpose/can/device.hpp"
#include "flatpose/can/frame.hpp"

namespace flatpose::can {

class Link {
 public:
  struct Received {
    enum class Kind : std::uint8_t { kNothing, kFrame, kBus };
    Kind kind = Kind::kNothing;
    Frame frame;
    BusEvent bus;  ///< What the controller tells of itself.
    /// When it came, on the machine's clock, never after it was received; kNever_us: not known.
    std::int64_t received_us = kNever_us;
  };

  /// The next that has come, never what was sent here; does not wait.
  [[nodiscard]] virtual Received receive() noexcept = 0;

  /// Returns whether it was taken. If not there is no room at the moment, or no bus: nothing was
  /// sent, and it may be offered again. An FD frame that the link does not carry is taken and lost.
  [[nodiscard]] virtual bool send(const Frame& frame) noexcept = 0;

 protected:
  ~Link() = default;
};

}  // namespace flatpose::can
