// Scenes of standing cylinders. Other parts are laid out as if each filled its own circle.

#include "port/sim/layout.hpp"

namespace flatpose::sim {
namespace {

constexpr double kPatternTurnMaxRad = 10.0 * kRadPerDeg;
constexpr double kPatternShiftMaxMm = 12.0;
constexpr int kPatternColumns = 7;
constexpr int kPatternRows = 5;

/// Rows of touching circles; every other row moved by `row_shift` of a pitch. The pattern as a
/// whole is turned and shifted a little. What would leave the field is left out.
void build_pattern(Layout& layout, double row_pitch, double row_shift) {
  const Part& part = *layout.target;
  const double pitch_mm = 2.0 * radius_mm(part);
  const double turn_rad = layout.random.uniform(-kPatternTurnMaxRad, kPatternTurnMaxRad);
  const Pose scan_T_pattern{
      rotation_about_z(turn_rad),
      {layout.random.uniform(-kPatternShiftMaxMm, kPatternShiftMaxMm),
       layout.random.uniform(-kPatternShiftMaxMm, kPatternShiftMaxMm), part.thickness_mm}};
  for (int row = 0; row < kPatternRows; ++row) {
    for (int column = 0; column < kPatternColumns; ++column) {
      const double shift = (row % 2 == 0 ? -0.5 : 0.5) * row_shift;
      const Vec3 p_mm{(column - 0.5 * (kPatternColumns - 1) + shift) * pitch_mm,
                      (row - 0.5 * (kPatternRows - 1)) * row_pitch * pitch_mm, 0.0};
      const Rotation own_turn = rotation_about_z(layout.random.uniform(-kPi, kPi));
      const Instance instance{layout.target, {own_turn, scan_T_pattern * p_mm}};
      if (layout.inside(instance)) layout.result.instances.push_back(instance);
    }
  }
  if (layout.result.instances.empty()) layout.no_room("part '" + part.name + "'");
}

}  // namespace

void build_cyl_loose(Layout& layout) {
  constexpr int kCylinderCount = 12;
  layout.place_or_throw(layout.target);
  for (int i = 1; i < kCylinderCount; ++i) {
    if (!layout.place(layout.target)) break;
  }
}

void build_cyl_grid(Layout& layout) { build_pattern(layout, 1.0, 0.0); }

void build_cyl_brick(Layout& layout) {
  constexpr double kHexagonalRowPitch = 0.5 * std::numbers::sqrt3;
  build_pattern(layout, kHexagonalRowPitch, 0.5);
}

}  // namespace flatpose::sim
