#pragma once
// The socket that clients connect to, and what is set on theirs.

#include <cstdint>
#include <string>

#include "port/linux/modbus/file_descriptor.hpp"

namespace flatpose::port {

struct Listener {
  FileDescriptor socket;
  std::string address;  ///< As bound.
  int port = 0;         ///< The real one, also when 0 was asked for.
};

/// Fails: InputError naming `subject` when the address is none of this machine's, the port is taken
/// or not allowed.
[[nodiscard]] Listener listen_on(const std::string& subject, const std::string& address, int port);

/// Takes the next connection, without waiting. Not open when there is none.
/// `peer` is its IPv4 address as a number.
[[nodiscard]] FileDescriptor accept_from(int listener, std::uint32_t& peer) noexcept;

}  // namespace flatpose::port
