#pragma once
// What the search hands on.

#include <cstdint>

#include "flatpose/geometry/pose.hpp"

namespace flatpose::search {

/// One hypothesis worth a closer look.
struct Candidate {
  std::int32_t cost_q10 = 0;  ///< Cost as a share of the worst at its own tilt, times 1024. The
                              ///< list is in order of the plain cost.
  std::int32_t angle_index = 0;
  std::int16_t column = 0;  ///< Of the cell.
  std::int16_t row = 0;
  std::int16_t anchor = 0;
  Pose work_T_object;
};

}  // namespace flatpose::search
