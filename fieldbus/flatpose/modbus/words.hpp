#pragma once
// 16-bit words in a row of bytes, the more significant byte first, as Modbus has them.

#include <cstddef>
#include <cstdint>
#include <span>

namespace flatpose::modbus {

[[nodiscard]] inline std::uint16_t word_at(std::span<const std::uint8_t> bytes,
                                           std::size_t index) noexcept {
  return static_cast<std::uint16_t>(bytes[index] << 8 | bytes[index + 1]);
}

inline void put_word(std::span<std::uint8_t> bytes, std::size_t index,
                     std::uint16_t word) noexcept {
  bytes[index] = static_cast<std::uint8_t>(word >> 8);
  bytes[index + 1] = static_cast<std::uint8_t>(word);
}

}  // namespace flatpose::modbus
