#pragma once
// Loops that always do the same: what they take beyond their usual time is the machine's doing. One
// only counts; who shares a core's arithmetic, its caches or the way to memory with others notices
// more than it does, so another one reads memory.

#include <cstdint>
#include <span>

namespace flatpose::bench {

/// Touches no memory.  Cost: the same number of steps each time, some nanosecond each.
[[nodiscard]] std::uint64_t spin(std::int64_t step_count) noexcept;

/// Steps that take this long, by the shortest of several tries.
[[nodiscard]] std::int64_t spin_steps_for(std::int64_t time_ns) noexcept;

/// Reads all of it and adds up.
[[nodiscard]] std::uint64_t sweep(std::span<const std::uint64_t> values) noexcept;

}  // namespace flatpose::bench
