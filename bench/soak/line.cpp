#include "bench/soak/line.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace flatpose::soak {

Line::Line(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(static_cast<std::uint16_t>(port));
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval limit{60, 0};
  const int one = 1;
  setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  if (connect(socket_.get(), reinterpret_cast<sockaddr*>(&name), sizeof name) != 0)
    throw std::system_error(errno, std::generic_category(), "connect");
}

std::int64_t Line::exchange_ns(std::span<const std::uint8_t> request,
                               std::span<std::uint8_t> response) {
  const std::int64_t start_ns = now_ns();
  const ssize_t sent = ::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL);
  if (sent != static_cast<ssize_t>(request.size()))
    throw std::runtime_error("a request was not taken");
  const ssize_t got = ::recv(socket_.get(), response.data(), response.size(), MSG_WAITALL);
  if (got != static_cast<ssize_t>(response.size()))
    throw std::runtime_error("an answer did not come");
  return now_ns() - start_ns;
}

}  // namespace flatpose::soak
