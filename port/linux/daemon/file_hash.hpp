#pragma once
// What is told of a file on the bus: 32 bits of its bytes, never 0, which says that there is none.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "flatpose/core/fnv.hpp"
#include "port/linux/daemon/section.hpp"
#include "port/linux/files/atomic_file.hpp"

namespace flatpose::daemon {

class FileHash {
 public:
  void add(std::span<const std::byte> bytes) noexcept { hash_.add(bytes); }
  /// Fails: port::InputError.
  void add_file(const std::string& path) { add(port::read_file(path, kConfigBytesMax)); }

  [[nodiscard]] std::uint32_t value() const noexcept {
    const auto folded = static_cast<std::uint32_t>(hash_.value() ^ hash_.value() >> 32);
    return folded == 0 ? 1 : folded;
  }

 private:
  Fnv1a64 hash_;
};

}  // namespace flatpose::daemon
