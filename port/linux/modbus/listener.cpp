#include "port/linux/modbus/listener.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

constexpr int kBacklog = 64;

// A peer that vanished without a word is noticed after some 20 s.
constexpr int kSilence_s = 10;
constexpr int kProbeEvery_s = 3;
constexpr int kProbes = 3;
constexpr int kUnsentLimit_ms = 20'000;

void set(int socket, int level, int name, int value) noexcept {
  (void)setsockopt(socket, level, name, &value, sizeof value);  // each is a nicety
}

void set_up(int socket) noexcept {
  set(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(socket, IPPROTO_TCP, TCP_KEEPIDLE, kSilence_s);
  set(socket, IPPROTO_TCP, TCP_KEEPINTVL, kProbeEvery_s);
  set(socket, IPPROTO_TCP, TCP_KEEPCNT, kProbes);
  set(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnsentLimit_ms);
}

std::string remedy_for(int error) {
  if (error == EADDRINUSE) return "end what listens there, or give another port";
  if (error == EACCES)
    return "give a port from 1024 on, or let the unit grant CAP_NET_BIND_SERVICE";
  return "give an address of this machine, or 0.0.0.0 for all";
}

}  // namespace

Listener listen_on(const std::string& subject, const std::string& address, int port) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, address.c_str(), &name.sin_addr) != 1)
    throw InputError(subject, "\"" + printable(address, 60) + "\" is no IPv4 address",
                     remedy_for(0));
  Listener made{FileDescriptor(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)),
                address, 0};
  const int number = made.socket.get();
  set(number, SOL_SOCKET, SO_REUSEADDR, 1);  // a restart does not wait for old connections
  socklen_t size = sizeof name;
  const bool is_bound = number >= 0 &&
                        bind(number, reinterpret_cast<sockaddr*>(&name), size) == 0 &&
                        listen(number, kBacklog) == 0 &&
                        getsockname(number, reinterpret_cast<sockaddr*>(&name), &size) == 0;
  if (!is_bound) {
    const int error = errno;
    throw InputError(
        subject,
        "cannot listen on " + address + ":" + std::to_string(port) + ": " + std::strerror(error),
        remedy_for(error));
  }
  made.port = ntohs(name.sin_port);
  return made;
}

FileDescriptor accept_from(int listener, std::uint32_t& peer) noexcept {
  sockaddr_in name{};
  socklen_t size = sizeof name;
  FileDescriptor socket(
      accept4(listener, reinterpret_cast<sockaddr*>(&name), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return socket;
  peer = ntohl(name.sin_addr.s_addr);
  set_up(socket.get());
  return socket;
}

}  // namespace flatpose::port
