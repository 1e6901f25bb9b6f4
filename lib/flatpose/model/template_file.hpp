#pragma once
// The template as bytes: little-endian, versioned, checksummed, the same on every machine.
//
//   0  magic "FPT\n"        4  version (u32)        8  size of the payload in bytes (u32)
//  12  FNV-1a 64 of the payload (u64)              20  payload: the fields of Template in order,
//  clouds by their counts

#include <cstddef>
#include <span>

#include "flatpose/core/result.hpp"
#include "flatpose/model/template.hpp"

namespace flatpose::model {

inline constexpr std::uint32_t kTemplateFileVersion = 2;
/// Enough for any template.
inline constexpr std::size_t kTemplateFileBytesMax = 32 * 1024;

/// Writes the template and returns the count of bytes.  Fails: kOutOfMemory (`bytes` too small),
/// kInvalidArgument.
[[nodiscard]] Result<std::size_t> write_template(const Template& part,
                                                 std::span<std::byte> bytes) noexcept;

/// Reads a template, believing nothing: counts, ranges and finiteness are checked.
/// Fails: kBadMagic, kBadVersion (newer than this library), kTruncated, kBadChecksum,
/// kInvalidArgument (values).
[[nodiscard]] Status read_template(std::span<const std::byte> bytes, Template& part) noexcept;

/// Whether every count, range and number of the template can be relied on.
[[nodiscard]] bool is_valid(const Template& part) noexcept;

}  // namespace flatpose::model
