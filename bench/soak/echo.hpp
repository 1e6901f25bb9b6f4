#pragma once
// What an exchange of bytes costs on this machine without anything behind it.

#include <cstddef>

namespace flatpose::soak {

/// A TCP server on a free port of 127.0.0.1, which it prints: answers so many bytes with so many,
/// one client at a time, until its standard input ends.
int serve_echo(std::size_t request_bytes, std::size_t response_bytes);

}  // namespace flatpose::soak
