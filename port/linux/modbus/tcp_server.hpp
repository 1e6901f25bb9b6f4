#pragma once
// The Modbus server's sockets in one epoll set: a listener, up to 16 clients, and one event that
// others wake the thread by. Nothing here blocks but wait(), and that no longer than it is told.
//
//   while (...) { server.wait(until); ...what others had to say...; server.serve(now, responder); }
//
// No client costs the others more than one buffer a turn; a frame or a response that is not through
// within a second ends its connection.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "port/linux/modbus/allow_list.hpp"
#include "port/linux/modbus/client.hpp"
#include "port/linux/modbus/listener.hpp"
#include "port/linux/modbus/seats.hpp"

namespace flatpose::port {

inline constexpr int kClientCountMax = 16;

class TcpServer {
 public:
  /// Listens from now on. `wake` is an eventfd, or -1; wait() empties it.
  /// Fails: InputError naming `subject`, std::system_error.
  TcpServer(const std::string& subject, const std::string& address, int port, int wake,
            AllowList allowed = {}, const ClientLimits& limits = {});

  [[nodiscard]] int port() const noexcept { return listener_.port; }
  /// "127.0.0.1:502"
  [[nodiscard]] std::string name() const;

  /// For who waits for other things too: readable when wait() would return at once.
  [[nodiscard]] int waitable() const noexcept { return epoll_.get(); }
  /// Until something is to be done, or for `time_us` at most.
  void wait(std::int64_t time_us) noexcept;
  /// Serves what wait() has seen, closes what is too slow, lets new clients in.
  void serve(std::int64_t now_us, Responder& responder) noexcept;
  /// When a connection has to be closed if nothing more comes; the far future: none.
  [[nodiscard]] std::int64_t deadline_us() const noexcept;

  [[nodiscard]] int client_count() const noexcept;

 private:
  void serve_client(int index, std::int64_t now_us, Responder& responder) noexcept;
  void close_slow(std::int64_t now_us) noexcept;
  void let_in(std::int64_t now_us, const Responder& responder) noexcept;
  void seat(int index, FileDescriptor socket, const job::Master& master,
            std::int64_t now_us) noexcept;
  [[nodiscard]] int choose_seat(std::int64_t now_us, const Responder& responder) const noexcept;
  bool watch(int operation, int socket, std::uint32_t events, int slot) noexcept;

  Listener listener_;
  FileDescriptor epoll_;
  int wake_ = -1;
  const AllowList allowed_;
  ClientLimits limits_;
  std::array<std::optional<Client>, kClientCountMax> clients_;
  std::array<bool, kClientCountMax> is_due_{};
  std::array<bool, kClientCountMax> is_watched_for_room_{};
  bool has_newcomers_ = false;
  std::uint64_t connection_count_ = 0;
};

}  // namespace flatpose::port
