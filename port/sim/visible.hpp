#pragma once
// What the truth says of a part: which share of its top shows.

#include "port/sim/world.hpp"

namespace flatpose::sim {

/// Samples over the top of a part for the truth; a line of them is 1 %.
inline constexpr double kTruthSamples = 10000.0;

/// Share of the top (areas counted in) that laser and camera both see.
/// Cost: about 1 us a sample.
[[nodiscard]] double visible_share(const World& world, const Ruler& ruler, const Instance& instance,
                                   double samples = kTruthSamples);

}  // namespace flatpose::sim
