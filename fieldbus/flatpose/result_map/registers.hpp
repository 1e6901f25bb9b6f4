#pragma once
// The map's values as registers, and what was written as a command: both straight from the table.
// A value that is too large for its type is held at the largest that is no "none".

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "flatpose/job/snapshot.hpp"
#include "flatpose/result_map/entry.hpp"

namespace flatpose::result_map {

/// How the four bytes of a 32-bit value lie in two registers; A is the most significant. 16-bit
/// values are as Modbus has them, always.
enum class WordOrder : std::uint8_t { kAbcd, kCdab, kBadc, kDcba };

struct WireFormat {
  WordOrder order = WordOrder::kAbcd;
  /// What stands for "there is none"; in 16 bits it is -32768 and 65535.
  std::uint32_t none_int32 = 0x80000000;
  std::uint32_t none_float32 = 0x7fc00000;  ///< The bits: a quiet NaN.
};

/// The registers of one entry; one or two, the rest 0.
[[nodiscard]] std::array<std::uint16_t, 2> encode(const Entry& entry, const job::Snapshot& snapshot,
                                                  const WireFormat& format) noexcept;

/// The same in the bits of its type, before any order.
[[nodiscard]] std::uint32_t raw_of(const Entry& entry, const job::Snapshot& snapshot,
                                   const WireFormat& format) noexcept;

/// Fills `registers` with those from `address` on; gaps are 0.  Needs: all inside the map.
void read_registers(const job::Snapshot& snapshot, const WireFormat& format, int address,
                    std::span<std::uint16_t> registers) noexcept;

/// Puts the registers written from `address` on into the image.  Needs: all writable.
void write_registers(job::CommandImage& image, int address,
                     std::span<const std::uint16_t> registers) noexcept;

/// Whether that range holds the field's register.
[[nodiscard]] bool touches(Field field, int address, int count) noexcept;

}  // namespace flatpose::result_map
