#include "flatpose/search/hypotheses.hpp"

#include "flatpose/search/projector.hpp"

namespace flatpose::search {

bool Hypotheses::is_wanted(int place_column, int place_row, int angle_index) const noexcept {
  const int column = place_column * stride_px;
  const int row = place_row * stride_px;
  const Tilt tilt = tilt_of(field.slope_x(column, row), field.slope_y(column, row));
  const Pose pose = work_T_object(column, row, tilt.rotation * turns[angle_index]);
  return origins->admits(pose.position_mm, origin_margin_mm);
}

}  // namespace flatpose::search
