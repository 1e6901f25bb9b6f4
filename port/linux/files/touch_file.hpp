#pragma once
// Points that a robot has touched, and where the scan shows them: a line a pair, six numbers in mm,
//   scan_x, scan_y, scan_z, robot_x, robot_y, robot_z
// with commas or semicolons between them. A first line of these names may give another order. Empty
// lines, and what follows a #, say nothing.

#include <string>
#include <string_view>
#include <vector>

#include "port/linux/files/robot_file.hpp"

namespace flatpose::port {

inline constexpr std::size_t kTouchedPairsMax = 10'000;

/// Fails: InputError, `FILE:LINE: WHAT; REMEDY`.
[[nodiscard]] std::vector<TouchedPair> read_touch_file(const std::string& path);

}  // namespace flatpose::port
