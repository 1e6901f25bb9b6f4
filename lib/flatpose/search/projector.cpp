#include "flatpose/search/projector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace flatpose::search {
namespace {

// To the nearest; saturates, since a point of a valid template may lie further off than 16 bits of
// cells reach. No call of floor(), and no branch: the compiler takes points several at a time.
inline std::int32_t rounded(double value) noexcept {
  constexpr double kMax = 32767.0;
  const double above = value + 0.5;
  const double low = above < -kMax ? -kMax : above;
  const double bounded = low > kMax ? kMax : low;
  const auto toward_zero = static_cast<std::int32_t>(bounded);
  return toward_zero - (static_cast<double>(toward_zero) > bounded ? 1 : 0);
}

// image::octant_of() without a branch: the octant among the first three, unfolded by the signs.
inline std::int32_t octant(float dx, float dy) noexcept {
  constexpr float kTanEighthOfPi = 0.41421356F;
  const float ax = std::fabs(dx);
  const float ay = std::fabs(dy);
  const std::int32_t steep = ax <= kTanEighthOfPi * ay ? 2 : 1;
  const std::int32_t folded = ay <= kTanEighthOfPi * ax ? 0 : steep;
  const std::int32_t half = dx >= 0.0F ? folded : 4 - folded;
  return (dy >= 0.0F ? half : 8 - half) & 7;
}

}  // namespace

Tilt tilt_of(double slope_x, double slope_y) noexcept {
  const Vec3 normal = normalized({-slope_x, -slope_y, 1.0});
  return {slope_x, slope_y, normal, tilt_rotation(normal)};
}

Projector::Projector(const model::Template& part, const model::Anchor& anchor,
                     const SearchImages& images, const ScoreConfig& config,
                     bool with_normals) noexcept
    : images_(images),
      with_normals_(with_normals),
      contour_count_(std::min({config.contour_count, kContourCountMax, part.contour_count})),
      surface_count_(std::min({config.surface_count, kSurfaceCountMax, part.surface_count})) {
  contour_count_ = std::max(contour_count_, 0);
  surface_count_ = std::max(surface_count_, 0);
  const Vec3 anchor_mm{anchor.x_mm, anchor.y_mm, 0.0};
  const auto put = [&](int i, const auto& p) {
    x_mm_[i] = p.x_mm - anchor_mm.x;
    y_mm_[i] = p.y_mm - anchor_mm.y;
    z_mm_[i] = p.z_mm - anchor_mm.z;
    nx_[i] = p.nx;
    ny_[i] = p.ny;
  };
  for (int i = 0; i < contour_count_; ++i) put(i, part.contour[i]);
  for (int i = 0; i < surface_count_; ++i) {
    const int at = contour_count_ + i;
    put(at, part.surface[i]);
    nz_[at] = std::sqrt(std::max(0.0, 1.0 - nx_[at] * nx_[at] - ny_[at] * ny_[at]));
  }
}

ProjectedTemplate Projector::at(const Tilt& tilt, const Rotation& turn) const noexcept {
  const Rotation work_R_object = tilt.rotation * turn;
  Shifts shifts;
  shift_all(tilt, work_R_object, shifts);
  ProjectedTemplate projected;
  projected.edge_factor_q8 =
      static_cast<std::int32_t>(std::min(256.0 / tilt.normal.z, 1.0 * kEdgeFactorMax_q8));
  add_contour(work_R_object, shifts, projected);
  add_surface(work_R_object, shifts, projected);
  return projected;
}

// The height is expected where the cell is, not where the point is.
void Projector::shift_all(const Tilt& tilt, const Rotation& work_R_object,
                          Shifts& shifts) const noexcept {
  const std::array<double, 9> m = work_R_object.m;
  const double slope_x = tilt.slope_x;
  const double slope_y = tilt.slope_y;
  const double cell_mm = images_.grid.cell_mm;
  const double unit_mm = images_.height_unit_mm;
  const int count = contour_count_ + surface_count_;
  for (int i = 0; i < count; ++i) {
    const double x_mm = m[0] * x_mm_[i] + m[1] * y_mm_[i] + m[2] * z_mm_[i];
    const double y_mm = m[3] * x_mm_[i] + m[4] * y_mm_[i] + m[5] * z_mm_[i];
    const double z_mm = m[6] * x_mm_[i] + m[7] * y_mm_[i] + m[8] * z_mm_[i];
    const std::int32_t dx = rounded(x_mm / cell_mm);
    const std::int32_t dy = rounded(y_mm / cell_mm);
    const double rise_mm = z_mm + slope_x * (dx * cell_mm - x_mm) + slope_y * (dy * cell_mm - y_mm);
    shifts.dx[i] = dx;
    shifts.dy[i] = dy;
    shifts.rise_unit[i] = rounded(rise_mm / unit_mm);
  }
}

bool Projector::is_within(const Shifts& shifts, int i) const noexcept {
  const int reach_px = images_.lattice.reach_px();
  return std::abs(shifts.dx[i]) <= reach_px && std::abs(shifts.dy[i]) <= reach_px;
}

void Projector::add_contour(const Rotation& work_R_object, const Shifts& shifts,
                            ProjectedTemplate& projected) const noexcept {
  const std::array<double, 9> m = work_R_object.m;
  std::array<std::int32_t, kContourCountMax> octants;
  for (int i = 0; i < contour_count_; ++i) {
    octants[i] = octant(static_cast<float>(m[0] * nx_[i] + m[1] * ny_[i]),
                        static_cast<float>(m[3] * nx_[i] + m[4] * ny_[i]));
  }
  for (int i = 0; i < contour_count_; ++i) {
    if (!is_within(shifts, i)) continue;
    projected.contour[projected.contour_count++] = {
        static_cast<std::int16_t>(shifts.dx[i]), static_cast<std::int16_t>(shifts.dy[i]),
        static_cast<std::int16_t>(octants[i]), static_cast<std::int16_t>(shifts.rise_unit[i])};
  }
}

void Projector::add_surface(const Rotation& work_R_object, const Shifts& shifts,
                            ProjectedTemplate& projected) const noexcept {
  for (int i = contour_count_; i < contour_count_ + surface_count_; ++i) {
    if (!is_within(shifts, i)) continue;
    ProjectedTemplate::Surface& to = projected.surface[projected.surface_count++];
    to = {static_cast<std::int16_t>(shifts.dx[i]), static_cast<std::int16_t>(shifts.dy[i]),
          static_cast<std::int16_t>(shifts.rise_unit[i])};
    if (!with_normals_) continue;
    const Vec3 turned = work_R_object * Vec3{nx_[i], ny_[i], nz_[i]};
    to.normal_x_unit = normal_unit(turned.x, images_.config);
    to.normal_y_unit = normal_unit(turned.y, images_.config);
  }
}

}  // namespace flatpose::search
