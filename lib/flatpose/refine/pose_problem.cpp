#include "flatpose/refine/pose_problem.hpp"

#include <algorithm>

#include "flatpose/autodiff/dual.hpp"
#include "flatpose/image/bilinear.hpp"
#include "flatpose/image/bspline.hpp"

namespace flatpose::refine {
namespace {

using Number = autodiff::Dual<6>;

struct NumberVec3 {
  Number x;
  Number y;
  Number z;
};

NumberVec3 rotated(const Rotation& r, const NumberVec3& v) noexcept {
  return {r.m[0] * v.x + r.m[1] * v.y + r.m[2] * v.z, r.m[3] * v.x + r.m[4] * v.y + r.m[5] * v.z,
          r.m[6] * v.x + r.m[7] * v.y + r.m[8] * v.z};
}

/// v + h_r x v, h_r being the first three parameters at zero.
NumberVec3 turned(const Vec3& v) noexcept {
  const Number rx = autodiff::seed<6>(0.0, 0);
  const Number ry = autodiff::seed<6>(0.0, 1);
  const Number rz = autodiff::seed<6>(0.0, 2);
  return {v.x + ry * v.z - rz * v.y, v.y + rz * v.x - rx * v.z, v.z + rx * v.y - ry * v.x};
}

NumberVec3 placed(const Pose& pose, const Vec3& p_object_mm) noexcept {
  NumberVec3 p = turned(p_object_mm);
  p.x += autodiff::seed<6>(0.0, 3);
  p.y += autodiff::seed<6>(0.0, 4);
  p.z += autodiff::seed<6>(0.0, 5);
  NumberVec3 q = rotated(pose.rotation, p);
  q.x += pose.position_mm.x;
  q.y += pose.position_mm.y;
  q.z += pose.position_mm.z;
  return q;
}

double squared_inverse(double sigma) noexcept { return 1.0 / (sigma * sigma); }

}  // namespace

Pose moved(const Pose& pose, const Vector<6>& step) noexcept {
  const Pose small{rotation_from_vector({step[0], step[1], step[2]}), {step[3], step[4], step[5]}};
  const Pose sum = pose * small;
  return {orthonormalized(sum.rotation), sum.position_mm};
}

Pose PoseProblem::plus(const Pose& pose, const Vector<6>& step) const noexcept {
  return moved(pose, step);
}

bool PoseProblem::evaluate(const Pose& pose, NormalEquations<6>* equations) const noexcept {
  if (!(pose.rotation.m[8] > 0.0)) return false;  // looks away from the sensor
  add_contour(pose, equations);
  add_surface(pose, equations);
  return true;
}

void PoseProblem::add_contour(const Pose& pose, NormalEquations<6>* equations) const noexcept {
  const double third_mm = images_.grid.cell_mm / 3.0;
  const double weight = squared_inverse(config_.edge_sigma_mm);
  const RobustLoss loss = RobustLoss::tukey(config_.edge_reach_mm);
  const int count = std::min(config_.contour_count, part_.contour_count);
  for (int i = 0; i < count; ++i) {
    const model::ContourPoint& p = part_.contour[i];
    const NumberVec3 q = placed(pose, {p.x_mm, p.y_mm, p.z_mm});
    const Vec3 falling = pose.rotation * Vec3{p.nx, p.ny, 0.0};
    const int octant =
        image::octant_of(static_cast<float>(falling.x), static_cast<float>(falling.y));
    const Number column = (q.x - images_.grid.x0_mm) / images_.grid.cell_mm;
    const Number row = (q.y - images_.grid.y0_mm) / images_.grid.cell_mm;
    const BoundedDistance distance(images_, octant);
    equations->add(image::bspline(distance, column, row) * third_mm, weight, loss);
  }
}

void PoseProblem::add_surface(const Pose& pose, NormalEquations<6>* equations) const noexcept {
  const double height_weight = squared_inverse(config_.height_sigma_mm);
  const double normal_weight = squared_inverse(config_.normal_sigma);
  const RobustLoss height_loss = RobustLoss::tukey(config_.height_reach_mm);
  // What hides the part lies above it, and may lie on it: less of a height above is believed.
  const RobustLoss covering_loss = RobustLoss::tukey(config_.covering_reach_mm);
  const RobustLoss normal_loss = RobustLoss::tukey(config_.normal_reach);
  const int count = std::min(config_.surface_count, part_.surface_count);
  for (int i = 0; i < count; ++i) {
    const model::SurfacePoint& p = part_.surface[i];
    const NumberVec3 q = placed(pose, {p.x_mm, p.y_mm, p.z_mm});
    const Number column = (q.x - images_.grid.x0_mm) / images_.grid.cell_mm;
    const Number row = (q.y - images_.grid.y0_mm) / images_.grid.cell_mm;
    const Number above_mm = image::bilinear(images_.filled_mm, column, row) - q.z;
    equations->add(above_mm, height_weight, above_mm.value > 0.0 ? covering_loss : height_loss);
    const double nz = std::sqrt(
        std::max(0.0, 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny));
    const NumberVec3 n = rotated(pose.rotation, turned({p.nx, p.ny, nz}));
    const ImageView<const float> normal_x = images_.normal_x;
    const ImageView<const float> normal_y = images_.normal_y;
    equations->add(image::bilinear(normal_x, column, row) - n.x, normal_weight, normal_loss);
    equations->add(image::bilinear(normal_y, column, row) - n.y, normal_weight, normal_loss);
  }
}

}  // namespace flatpose::refine
