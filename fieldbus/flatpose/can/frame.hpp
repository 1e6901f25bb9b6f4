#pragma once
// A classic CAN frame, the identifiers that a CANopen node gives and takes (CiA 301, predefined
// connection set), and numbers in bytes, the less significant first.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flatpose::can {

inline constexpr std::size_t kFrameBytesMax = 8;

struct Frame {
  std::uint32_t id = 0;
  std::uint8_t size = 0;  ///< 0 to 8.
  bool is_extended = false;
  bool is_remote = false;
  std::array<std::uint8_t, kFrameBytesMax> data{};

  friend bool operator==(const Frame&, const Frame&) = default;
};

inline constexpr int kNodeMax = 127;
inline constexpr int kTpdoCount = 4;

inline constexpr std::uint32_t kNmtId = 0x000;
inline constexpr std::uint32_t kSyncId = 0x080;
inline constexpr std::uint32_t kEmergencyBase = 0x080;
inline constexpr std::uint32_t kTpdoBase = 0x180;  ///< Of the first; the next 100h further on.
inline constexpr std::uint32_t kTpdoStep = 0x100;
inline constexpr std::uint32_t kRpdoBase = 0x200;
inline constexpr std::uint32_t kSdoAnswerBase = 0x580;
inline constexpr std::uint32_t kSdoRequestBase = 0x600;
inline constexpr std::uint32_t kHeartbeatBase = 0x700;

[[nodiscard]] constexpr std::uint32_t tpdo_id(int index, std::uint8_t node) noexcept {
  return kTpdoBase + kTpdoStep * static_cast<std::uint32_t>(index) + node;
}

/// Needs: `bytes` no more than four from `at` on.
[[nodiscard]] constexpr std::uint32_t number_at(std::span<const std::uint8_t> data, std::size_t at,
                                                std::size_t bytes) noexcept {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    number |= static_cast<std::uint32_t>(data[at + i]) << (8 * i);
  return number;
}

constexpr void put_number(std::span<std::uint8_t> data, std::size_t at, std::size_t bytes,
                          std::uint32_t number) noexcept {
  for (std::size_t i = 0; i < bytes; ++i)
    data[at + i] = static_cast<std::uint8_t>(number >> (8 * i));
}

}  // namespace flatpose::can
