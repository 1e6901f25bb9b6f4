#pragma once
// A finder of the C API with memory of its own.

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "flatpose/flatpose.h"
#include "flatpose/geometry/range_image.hpp"

namespace flatpose::test {

inline flatpose_limits c_limits(bool can_teach = false) {
  flatpose_limits limits = FLATPOSE_LIMITS_INIT;
  limits.scan_width_px = 300;
  limits.scan_height_px = 250;
  limits.cell_count = 120'000;
  limits.can_teach = can_teach ? 1 : 0;
  return limits;
}

inline flatpose_scan c_scan(const RangeImageView& view) {
  flatpose_scan scan = FLATPOSE_SCAN_INIT;
  scan.x_mm = view.x_mm;
  scan.y_mm = view.y_mm;
  scan.z_mm = view.z_mm;
  scan.width_px = view.width_px;
  scan.height_px = view.height_px;
  scan.pixel_stride_bytes = view.pixel_stride_bytes;
  scan.row_stride_bytes = view.row_stride_bytes;
  return scan;
}

/// In memory of odd alignment.
struct CFinder {
  std::vector<std::byte> memory;
  flatpose_finder* handle = nullptr;

  explicit CFinder(bool can_teach = false) {
    const flatpose_limits limits = c_limits(can_teach);
    memory.resize(flatpose_required_bytes(&limits) + 1);
    EXPECT_EQ(flatpose_init(&limits, memory.data() + 1, memory.size() - 1, &handle),
              FLATPOSE_STATUS_OK);
  }
};

}  // namespace flatpose::test
