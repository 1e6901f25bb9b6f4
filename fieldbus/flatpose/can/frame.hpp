#pragma once
// A CAN frame, classic or FD, the identifiers that a CANopen node gives and takes (CiA 301,
// predefined connection set), and numbers in bytes, the less significant first.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flatpose::can {

inline constexpr std::size_t kClassicBytesMax = 8;
inline constexpr std::size_t kFdBytesMax = 64;

struct Frame {
  std::uint32_t id = 0;
  std::uint8_t size = 0;  ///< 0 to 8; of an FD frame 12, 16, 20, 24, 32, 48 and 64 too.
  bool is_extended = false;
  bool is_remote = false;
  bool is_fd = false;
  bool has_bit_rate_switch = false;  ///< Of an FD frame: its data have the faster bit rate.
  std::array<std::uint8_t, kFdBytesMax> data{};

  /// Needs: no more than fit.
  constexpr void fill(std::span<const std::uint8_t> bytes) noexcept {
    size = static_cast<std::uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), data.begin());
  }

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
/// RPDO4's, which this node does not have: so it is this node's own, and there is one for each of
/// the 127. What CiA 301 leaves free, 680h to 6DFh, is too narrow for that.
inline constexpr std::uint32_t kFdReportBase = 0x500;
inline constexpr std::uint32_t kSdoAnswerBase = 0x580;
inline constexpr std::uint32_t kSdoRequestBase = 0x600;
inline constexpr std::uint32_t kHeartbeatBase = 0x700;

[[nodiscard]] constexpr std::uint32_t tpdo_id(int index, std::uint8_t node) noexcept {
  return kTpdoBase + kTpdoStep * static_cast<std::uint32_t>(index) + node;
}

/// Whether the whole result may have this identifier: one for PDOs or free in CiA 301, and no other
/// of this node's.
[[nodiscard]] constexpr bool is_fd_report_id(std::uint32_t id, std::uint8_t node) noexcept {
  if (id == kRpdoBase + node) return false;
  for (int i = 0; i < kTpdoCount; ++i) {
    if (id == tpdo_id(i, node)) return false;
  }
  return (id > 0x180 && id < 0x580) || (id >= 0x680 && id < 0x6e0);
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
