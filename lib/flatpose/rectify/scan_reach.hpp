#pragma once
// Where groups of a scan's rows lie in the work frame: who paints a part of the map need not look
// at the others.

#include <array>
#include <limits>

namespace flatpose::rectify {

struct ScanReach {
  static constexpr int kGroupCountMax = 512;
  static constexpr float kFar_mm = std::numeric_limits<float>::infinity();

  struct Box {
    float x_min_mm = kFar_mm;  ///< Nothing there: the least is more than the most.
    float x_max_mm = -kFar_mm;
    float y_min_mm = kFar_mm;
    float y_max_mm = -kFar_mm;
  };

  int scan_height_px = 0;    ///< 0: not known.
  float rounding_mm = 0.0F;  ///< A point may lie so far beyond its box.
  std::array<Box, kGroupCountMax> boxes;

  [[nodiscard]] int rows_per_group() const noexcept {
    return (scan_height_px + kGroupCountMax - 1) / kGroupCountMax;
  }
};

}  // namespace flatpose::rectify
