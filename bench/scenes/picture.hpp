#pragma once
// A failure drawn: the shaded height map, every instance of the part as it truly lies (green; thin
// where it is not half visible) with its visible share, every match (orange when right, else red)
// with its score.

#include <cstddef>
#include <string>
#include <vector>

#include "bench/scenes/trial.hpp"

namespace flatpose::bench {

/// The picture as PNG.  Fails: InputError when the scan cannot be rectified, std::bad_alloc.
[[nodiscard]] std::vector<std::byte> draw_trial(const Shot& shot, const Trial& trial,
                                                const std::string& title);

}  // namespace flatpose::bench
