#pragma once
// One connection: bytes in, frames to the responder, its answers out, never waiting for either.
// What could not be sent yet is one response; until it has gone nothing more is read, so a client
// that does not read its answers costs itself alone.

#include <array>
#include <cstdint>
#include <limits>

#include "flatpose/job/master.hpp"
#include "flatpose/modbus/adu.hpp"
#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::port {

/// Who answers.
class Responder {
 public:
  /// Writes the response and returns its size; 0 closes the connection.
  [[nodiscard]] virtual std::size_t respond(
      const job::Master& master, const modbus::Adu& adu,
      std::span<std::uint8_t, modbus::kAduBytesMax> response) noexcept = 0;
  /// Whoever holds the lease: its connection is not dropped for another's.
  [[nodiscard]] virtual job::Address owner() const noexcept = 0;

 protected:
  ~Responder() = default;
};

struct ClientLimits {
  std::int64_t frame_us = 1'000'000;  ///< From a frame's first byte to its last.
  std::int64_t send_us = 1'000'000;   ///< From a response to its last byte taken by the system.
};

class Client {
 public:
  static constexpr std::int64_t kNever_us = std::numeric_limits<std::int64_t>::max();

  Client(FileDescriptor socket, const job::Master& master, std::int64_t now_us) noexcept
      : socket_(std::move(socket)), master_(master), heard_us_(now_us) {}

  /// Does what can be done now.  Returns false when the connection is to be closed.
  /// Cost: bounded: one buffer is read and what it holds is answered.
  [[nodiscard]] bool go_on(std::int64_t now_us, const ClientLimits& limits,
                           Responder& responder) noexcept;

  [[nodiscard]] int socket() const noexcept { return socket_.get(); }
  [[nodiscard]] const job::Master& master() const noexcept { return master_; }
  /// Has a response that waits for room.
  [[nodiscard]] bool is_sending() const noexcept { return sent_bytes_ < response_bytes_; }
  [[nodiscard]] bool has_sent_a_frame() const noexcept { return has_sent_a_frame_; }
  /// When the last whole frame came; before that, when it connected.
  [[nodiscard]] std::int64_t heard_us() const noexcept { return heard_us_; }
  /// When it is to be closed for being too slow.
  [[nodiscard]] std::int64_t deadline_us() const noexcept { return deadline_us_; }

 private:
  [[nodiscard]] bool receive() noexcept;
  [[nodiscard]] bool send() noexcept;

  FileDescriptor socket_;
  job::Master master_;
  modbus::AduReader reader_;
  std::array<std::uint8_t, modbus::kAduBytesMax> response_{};
  std::size_t response_bytes_ = 0;
  std::size_t sent_bytes_ = 0;
  std::int64_t heard_us_ = 0;
  std::int64_t deadline_us_ = kNever_us;
  bool has_sent_a_frame_ = false;
};

}  // namespace flatpose::port
