#pragma once
// The register map: one table, from which registers are filled, requests are checked, and all
// documents and function blocks are made. What stands in it keeps its place; new lines go into the
// gaps or to the end, and count map_version up.

#include <cstdint>
#include <span>

#include "flatpose/result_map/entry.hpp"

namespace flatpose::result_map {

inline constexpr std::uint16_t kMapVersion = 2;
inline constexpr int kRegisterCount = 384;   ///< Readable; gaps between entries read 0.
inline constexpr int kResultAddress = 100;   ///< The block that is read whole.
inline constexpr int kResultWords = 96;      ///< At most 125: one read.
inline constexpr int kFurtherAddress = 200;  ///< The eight short blocks.
inline constexpr int kFurtherWords = 20;
inline constexpr int kFurtherBlocks = 8;
inline constexpr int kFurtherPickAddress = 360;  ///< Eight more: how each is to be picked.
inline constexpr int kFurtherPickWords = 3;

/// All entries, by rising address, none over another.
[[nodiscard]] std::span<const Entry> entries() noexcept;

/// The entry that a register belongs to; null in a gap and beyond the end.
[[nodiscard]] const Entry* entry_at(int address) noexcept;

/// Null when there is none.
[[nodiscard]] const Entry* find(Field field) noexcept;

[[nodiscard]] bool is_writable(int address) noexcept;

}  // namespace flatpose::result_map
