#include "flatpose/search/projector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace flatpose::search {

void lay_points_portable(const PointSet& points, const LaidPlane& plane, LaidPoints& laid) noexcept;
void lay_points_avx2(const PointSet& points, const LaidPlane& plane, LaidPoints& laid) noexcept;
void lay_points_avx512(const PointSet& points, const LaidPlane& plane, LaidPoints& laid) noexcept;

LayPoints lay_points_for(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, lay_points_portable, lay_points_avx2, lay_points_avx512);
}

Tilt tilt_of(double slope_x, double slope_y) noexcept {
  const Vec3 normal = normalized({-slope_x, -slope_y, 1.0});
  return {slope_x, slope_y, normal, tilt_rotation(normal)};
}

Projector::Projector(const model::Template& part, const model::Anchor& anchor,
                     const SearchImages& images, const ScoreConfig& config, bool with_normals,
                     VectorPath path) noexcept
    : images_(images), with_normals_(with_normals), lay_(lay_points_for(path)) {
  const int contour_count =
      std::max(0, std::min({config.contour_count, kContourCountMax, part.contour_count}));
  const int surface_count =
      std::max(0, std::min({config.surface_count, kSurfaceCountMax, part.surface_count}));
  points_.contour_count = contour_count;
  points_.count = contour_count + surface_count;
  const Vec3 anchor_mm{anchor.x_mm, anchor.y_mm, 0.0};
  const auto put = [&](int i, const auto& p) {
    points_.x_mm[i] = p.x_mm - anchor_mm.x;
    points_.y_mm[i] = p.y_mm - anchor_mm.y;
    points_.z_mm[i] = p.z_mm - anchor_mm.z;
    points_.nx[i] = p.nx;
    points_.ny[i] = p.ny;
  };
  for (int i = 0; i < contour_count; ++i) put(i, part.contour[i]);
  for (int i = 0; i < surface_count; ++i) {
    const int at = contour_count + i;
    put(at, part.surface[i]);
    const double nx = points_.nx[at];
    const double ny = points_.ny[at];
    points_.nz[at] = std::sqrt(std::max(0.0, 1.0 - nx * nx - ny * ny));
  }
}

ProjectedTemplate Projector::at(const Tilt& tilt, const Rotation& turn) const noexcept {
  const Rotation work_R_object = tilt.rotation * turn;
  LaidPoints laid;
  lay_(points_,
       {work_R_object.m, tilt.slope_x, tilt.slope_y, images_.grid.cell_mm, images_.height_unit_mm},
       laid);
  ProjectedTemplate projected;
  projected.edge_factor_q8 =
      static_cast<std::int32_t>(std::min(256.0 / tilt.normal.z, 1.0 * kEdgeFactorMax_q8));
  add_contour(laid, projected);
  add_surface(work_R_object, laid, projected);
  return projected;
}

double Projector::reach_px() const noexcept {
  double squared_mm2 = 0.0;
  for (int i = 0; i < points_.count; ++i) {
    const double x_mm = points_.x_mm[i];
    const double y_mm = points_.y_mm[i];
    const double z_mm = points_.z_mm[i];
    squared_mm2 = std::max(squared_mm2, x_mm * x_mm + y_mm * y_mm + z_mm * z_mm);
  }
  return std::sqrt(squared_mm2) / images_.grid.cell_mm;
}

void Projector::add_contour(const LaidPoints& laid, ProjectedTemplate& projected) const noexcept {
  const int reach_px = images_.lattice.reach_px();
  int count = 0;
  for (int i = 0; i < points_.contour_count; ++i) {
    projected.contour[count] = {
        static_cast<std::int16_t>(laid.dx[i]), static_cast<std::int16_t>(laid.dy[i]),
        static_cast<std::int16_t>(laid.octant[i]), static_cast<std::int16_t>(laid.rise_unit[i])};
    count += std::abs(laid.dx[i]) <= reach_px && std::abs(laid.dy[i]) <= reach_px ? 1 : 0;
  }
  projected.contour_count = count;
}

void Projector::add_surface(const Rotation& work_R_object, const LaidPoints& laid,
                            ProjectedTemplate& projected) const noexcept {
  const int reach_px = images_.lattice.reach_px();
  int count = 0;
  for (int i = points_.contour_count; i < points_.count; ++i) {
    if (std::abs(laid.dx[i]) > reach_px || std::abs(laid.dy[i]) > reach_px) continue;
    ProjectedTemplate::Surface& to = projected.surface[count++];
    to = {static_cast<std::int16_t>(laid.dx[i]), static_cast<std::int16_t>(laid.dy[i]),
          static_cast<std::int16_t>(laid.rise_unit[i])};
    if (!with_normals_) continue;
    const Vec3 turned = work_R_object * Vec3{points_.nx[i], points_.ny[i], points_.nz[i]};
    to.normal_x_unit = normal_unit(turned.x, images_.config);
    to.normal_y_unit = normal_unit(turned.y, images_.config);
  }
  projected.surface_count = count;
}

}  // namespace flatpose::search
