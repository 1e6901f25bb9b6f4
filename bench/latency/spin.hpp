#pragma once
// Loops that always do the same: what they take beyond their usual time is the machine's doing. One
// only calculates, another one reads memory, because who shares caches and the way to memory with
// others notices more than the first does.

#include <cstdint>
#include <span>

namespace flatpose::bench {

/// Touches no memory.  Cost: the same number of steps each time, some nanoseconds each.
[[nodiscard]] std::uint64_t spin(std::int64_t step_count) noexcept;

/// Reads all of it and adds up.
[[nodiscard]] std::uint64_t sweep(std::span<const std::uint64_t> values) noexcept;

}  // namespace flatpose::bench
