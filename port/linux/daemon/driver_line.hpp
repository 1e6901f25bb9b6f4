#pragma once
// The connection to one camera driver: whole messages, checked for form, never waited for.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "flatpose/camera_protocol.h"
#include "port/linux/daemon/sealed_memory.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::daemon {

/// Room for any message, and a byte more, so that a longer one is found out.
union DriverMessage {
  flatpose_camera_head head;
  flatpose_camera_hello_message hello;
  flatpose_camera_done_message done;
  flatpose_camera_reason_message reason;
  std::array<std::byte, sizeof(flatpose_camera_reason_message) + 1> bytes;
};

enum class Heard : std::uint8_t {
  kMessage,
  kNothing,  ///< At the moment.
  kClosed,
  kGarbage,  ///< Of another magic, version, size or kind.
  kFlood,
};

class DriverLine {
 public:
  DriverLine() = default;
  DriverLine(port::FileDescriptor socket, std::int64_t now_us) noexcept
      : socket_(std::move(socket)), since_us_(now_us), heard_us_(now_us), second_us_(now_us) {}

  [[nodiscard]] bool is_open() const noexcept { return socket_.is_open(); }
  [[nodiscard]] int socket() const noexcept { return socket_.get(); }
  [[nodiscard]] std::int64_t since_us() const noexcept { return since_us_; }
  [[nodiscard]] std::int64_t heard_us() const noexcept { return heard_us_; }

  [[nodiscard]] Heard hear(DriverMessage& message, std::int64_t now_us) noexcept;
  /// One message more is no flood: the answer to a request.
  void expect_answer() noexcept { --count_; }
  /// Whether it was sent whole: a driver that does not read is no use. `file`: goes with it.
  bool say(const void* message, std::size_t bytes, int file = -1) const noexcept;
  bool say_refused(std::string_view reason) const noexcept;

  /// Of the driver that it is now the line of.
  std::string name;
  bool is_simulated = false;
  SealedMemory memory;

 private:
  port::FileDescriptor socket_;
  std::int64_t since_us_ = 0;
  std::int64_t heard_us_ = 0;
  std::int64_t second_us_ = 0;  ///< In which messages are counted.
  int count_ = 0;
};

[[nodiscard]] flatpose_camera_head camera_head(flatpose_camera_kind kind, std::size_t bytes,
                                               std::uint32_t ticket) noexcept;
/// A text that a driver sent, fit for a log.
[[nodiscard]] std::string camera_text(const char* text, std::size_t bytes);

}  // namespace flatpose::daemon
