#pragma once
// FNV-1a, 64 bits: the checksum of templates and the digest of results.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flatpose {

class Fnv1a64 {
 public:
  void add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte b : bytes) add_byte(static_cast<std::uint8_t>(b));
  }
  void add(std::uint64_t value) noexcept {  // little-endian
    for (int shift = 0; shift < 64; shift += 8) add_byte(static_cast<std::uint8_t>(value >> shift));
  }
  void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  void add_byte(std::uint8_t byte) noexcept { hash_ = (hash_ ^ byte) * 0x100000001b3ULL; }

  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace flatpose
