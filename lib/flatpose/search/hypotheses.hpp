#pragma once
// Places times angles: what pose each stands for, and whether its origin may lie there.

#include <span>

#include "flatpose/model/template.hpp"
#include "flatpose/rectify/survey.hpp"
#include "flatpose/search/origin_bounds.hpp"
#include "flatpose/search/tilt_field.hpp"

namespace flatpose::search {

struct Hypotheses {
  const TiltField& field;
  const rectify::Grid& grid;
  const model::Anchor& anchor;
  std::span<const Rotation> turns;  ///< By angle.
  int stride_px = 1;
  const OriginBounds* origins = nullptr;
  double origin_margin_mm = 0.0;

  /// Of a cell, not of a place.
  [[nodiscard]] Pose work_T_object(int column, int row,
                                   const Rotation& tilt_and_turn) const noexcept {
    const Vec3 anchor_work_mm{grid.x_of(column), grid.y_of(row), field.plane_mm(column, row)};
    return {tilt_and_turn, anchor_work_mm - tilt_and_turn * Vec3{anchor.x_mm, anchor.y_mm, 0.0}};
  }

  /// Of a place in the lattice.  Needs origins.
  [[nodiscard]] bool is_wanted(int place_column, int place_row, int angle_index) const noexcept;
};

}  // namespace flatpose::search
