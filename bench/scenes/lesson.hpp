#pragma once
// Teaching as a user would: some scans of the lone part in different turns, by the sensor that will
// look for it, with the part's symmetry declared. Seeds of their own, so that no scan that is
// searched later has been learned from.

#include <array>
#include <cstdint>
#include <string>

#include "flatpose/teach/teacher.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/sim/simulate.hpp"

namespace flatpose::bench {

/// A straight edge along the sensor's grid is measured to a fraction of a step only; other turns
/// take that out.
inline constexpr std::array<std::uint64_t, 3> kTeachSeeds{9001, 9002, 9003};

struct Taught {
  model::Template part;
  teach::TeachReport report;
  int fold = 1;  ///< Of the symmetry, as the catalogue has it.
  /// From the simulator's part frame to the frame that was taught. The first teach scan fixes it:
  /// where the part lay is known there, and where teach saw it.
  Pose object_T_part;
};

/// Fails: std::invalid_argument (part, sensor), std::runtime_error when teach fails.
[[nodiscard]] Taught teach_part(const std::string& part, const sim::SensorConfig& sensor,
                                std::span<const std::uint64_t> seeds = kTeachSeeds);

/// A simulated scan as the tool would have loaded it from a file.
[[nodiscard]] tool::LoadedScan as_loaded(sim::SimulatedScan&& scan);

}  // namespace flatpose::bench
