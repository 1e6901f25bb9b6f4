#pragma once
// A loop that only counts: what it takes beyond its shortest time is the machine's doing.

#include <cstdint>

namespace flatpose::bench {

/// Touches no memory.  Cost: the same number of steps each time, some nanosecond each.
[[nodiscard]] std::uint64_t spin(std::int64_t step_count) noexcept;

/// Steps that take this long, by the shortest of several tries.
[[nodiscard]] std::int64_t spin_steps_for(std::int64_t time_ns) noexcept;

}  // namespace flatpose::bench
