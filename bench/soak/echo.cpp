#include "bench/soak/echo.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <iostream>
#include <thread>
#include <vector>

#include "port/linux/modbus/file_descriptor.hpp"
#include "port/linux/modbus/listener.hpp"

namespace flatpose::soak {
namespace {

// Epoll and non-blocking sockets would be fairer to the daemon; a blocking echo is the faster.
void serve_one(int socket, std::size_t request_bytes, std::size_t response_bytes) {
  const int one = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  std::vector<std::uint8_t> request(request_bytes);
  const std::vector<std::uint8_t> response(response_bytes);
  while (recv(socket, request.data(), request.size(), MSG_WAITALL) ==
         static_cast<ssize_t>(request.size())) {
    if (send(socket, response.data(), response.size(), MSG_NOSIGNAL) < 0) return;
  }
}

}  // namespace

int serve_echo(std::size_t request_bytes, std::size_t response_bytes) {
  port::Listener listener = port::listen_on("echo", "127.0.0.1", 0);
  std::cout << listener.port << std::endl;
  std::thread([] {
    char byte = 0;
    while (::read(STDIN_FILENO, &byte, 1) > 0) {
    }
    _exit(0);
  }).detach();
  while (true) {
    pollfd waited{listener.socket.get(), POLLIN, 0};
    if (poll(&waited, 1, -1) < 0) return 1;
    const port::FileDescriptor client(accept(listener.socket.get(), nullptr, nullptr));
    if (client.is_open()) serve_one(client.get(), request_bytes, response_bytes);
  }
}

}  // namespace flatpose::soak
