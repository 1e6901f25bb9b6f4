#pragma once
// How many bytes a second this machine can load: vectors of one width, nothing done with them, from
// memory that fits a level of the cache. The roof over everything that sums shifted images.

#include <cstddef>
#include <cstdint>

#include "flatpose/core/vector_path.hpp"

namespace flatpose::bench {

inline constexpr std::size_t kL1Bytes = 16 * 1024;
inline constexpr std::size_t kL2Bytes = 512 * 1024;
inline constexpr std::size_t kLoadPaddingBytes = 128;

/// Loads `size_bytes` (a multiple of 1024) from `first`, which may stand at any byte. A search's
/// loads stand at any byte, and those across two cache lines count twice.
using LoadAll = void (*)(const std::uint8_t* first, std::size_t size_bytes);
[[nodiscard]] LoadAll load_all_for(VectorPath path);

}  // namespace flatpose::bench
