#pragma once
// Simulated scans and taught parts for the benches, made once and kept.

#include <string>
#include <vector>

#include "bench/scenes/lesson.hpp"
#include "bench/scenes/trial.hpp"

namespace flatpose::bench {

struct ScanSize {
  std::string name;
  int columns = 600;
  int rows = 500;
};
inline const ScanSize kSmallScan{"600x500", 600, 500};
inline const ScanSize kLargeScan{"1536x1280", 1536, 1280};

/// Seeds 0 to `count`, the simulator's usual field and noise. Kept; made on both cores.
[[nodiscard]] const std::vector<Shot>& shots_of(const std::string& scene, const std::string& part,
                                                const ScanSize& size, int count);

/// Taught by the usual sensor, so that its cell is 1 mm whatever the scan. Kept.
[[nodiscard]] const Taught& taught(const std::string& part);

/// Cylinders stand in scenes of cylinders, pads in all others.
[[nodiscard]] std::string part_in(const std::string& scene);

}  // namespace flatpose::bench
