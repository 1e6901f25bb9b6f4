#include "flatpose/refine/pose_problem.hpp"

#include <algorithm>

#include "flatpose/autodiff/dual.hpp"
#include "flatpose/image/bilinear.hpp"
#include "flatpose/image/bspline.hpp"

namespace flatpose::refine {
namespace {

// What is read off an image is a dual number over the place in it, (column, row). How the place
// follows the six parameters is known in closed form, so a residual's row is one more step of the
// chain rule: with q = R (p + h_r x p + h_t) + t and a residual whose gradient over q is g,
//   (1)  g . dq = (R^T g) . (h_r x p + h_t) = (p x R^T g) . h_r + (R^T g) . h_t.
// A normal n = R (m + h_r x m) adds n_x = n . e_x, likewise,
//   (2)  e_x . dn = (m x R^T e_x) . h_r,     R^T e_x the first row of R.
using Number = autodiff::Dual<2>;

struct Place {
  double column;
  double row;
};

inline Place place(const rectify::Grid& grid, const Vec3& q_work_mm) noexcept {
  return {(q_work_mm.x - grid.x0_mm) / grid.cell_mm, (q_work_mm.y - grid.y0_mm) / grid.cell_mm};
}

inline Number read_at(const image::Sample& sample, const Place& at) noexcept {
  return image::lift(sample, autodiff::seed<2>(at.column, 0), autodiff::seed<2>(at.row, 1));
}

/// The turn and the shift of a row.
struct Row {
  Vec3 turn;
  Vec3 shift;

  operator Vector<6>() const noexcept {  // NOLINT: a row is a vector of six
    Vector<6> row;
    row << turn.x, turn.y, turn.z, shift.x, shift.y, shift.z;
    return row;
  }
};

/// Equation (1).
inline Row row_of_point(const Rotation& r, const Vec3& p_object_mm, const Vec3& g) noexcept {
  const Vec3 u{r.m[0] * g.x + r.m[3] * g.y + r.m[6] * g.z,
               r.m[1] * g.x + r.m[4] * g.y + r.m[7] * g.z,
               r.m[2] * g.x + r.m[5] * g.y + r.m[8] * g.z};
  return {cross(p_object_mm, u), u};
}

/// The distance in the cell that the spline's pixels lie around.
inline int distance_at(const BoundedDistance& distance, const Place& at) noexcept {
  const double column = image::clamp_coordinate(at.column, distance.width_px).at;
  const double row = image::clamp_coordinate(at.row, distance.height_px).at;
  return distance(static_cast<int>(column), static_cast<int>(row));
}

/// Where the distance is as large as this, the spline is beyond the reach whatever it reads: its
/// pixels are no more than two cells away, over which a chamfer distance falls by 8 at most.
int surely_far_third_px(double reach_third_px) noexcept {
  constexpr double kFallMax = 8.0;
  return static_cast<int>(std::min(reach_third_px, 255.0) + kFallMax) + 2;
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
  const double cells_per_mm = 1.0 / images_.grid.cell_mm;
  const double weight = squared_inverse(config_.edge_sigma_mm);
  const RobustLoss loss = RobustLoss::tukey(config_.edge_reach_mm);
  const double rejected_cost = weight * loss(2.0 * config_.edge_reach_mm).cost;
  const int far_third_px = surely_far_third_px(config_.edge_reach_mm / third_mm);
  const int count = std::min(config_.contour_count, part_.contour_count);
  for (int i = 0; i < count; ++i) {
    const model::ContourPoint& p = part_.contour[i];
    const Vec3 p_mm{p.x_mm, p.y_mm, p.z_mm};
    const Vec3 q_mm = pose * p_mm;
    const Vec3 falling = pose.rotation * Vec3{p.nx, p.ny, 0.0};
    const int octant =
        image::octant_of(static_cast<float>(falling.x), static_cast<float>(falling.y));
    const BoundedDistance distance(images_, octant);
    const Place at = place(images_.grid, q_mm);
    if (distance_at(distance, at) >= far_third_px) {
      equations->add_rejected(rejected_cost);
      continue;
    }
    const Number r = third_mm * read_at(image::bspline_sample(distance, at.column, at.row), at);
    const auto row = [&]() -> Vector<6> {
      return row_of_point(pose.rotation, p_mm,
                          {r.derivative[0] * cells_per_mm, r.derivative[1] * cells_per_mm, 0.0});
    };
    equations->add_lazily(r.value, row, weight, loss);
  }
}

void PoseProblem::add_surface(const Pose& pose, NormalEquations<6>* equations) const noexcept {
  const double height_weight = squared_inverse(config_.height_sigma_mm);
  const double normal_weight = squared_inverse(config_.normal_sigma);
  const RobustLoss height_loss = RobustLoss::tukey(config_.height_reach_mm);
  // What hides the part lies above it, and may lie on it: less of a height above is believed.
  const RobustLoss covering_loss = RobustLoss::tukey(config_.covering_reach_mm);
  const RobustLoss normal_loss = RobustLoss::tukey(config_.normal_reach);
  const double cells_per_mm = 1.0 / images_.grid.cell_mm;
  const Rotation& r = pose.rotation;
  const Vec3 x_axis{r.m[0], r.m[1], r.m[2]};  // in the object's frame
  const Vec3 y_axis{r.m[3], r.m[4], r.m[5]};
  const int count = std::min(config_.surface_count, part_.surface_count);
  for (int i = 0; i < count; ++i) {
    const model::SurfacePoint& p = part_.surface[i];
    const Vec3 p_mm{p.x_mm, p.y_mm, p.z_mm};
    const Vec3 q_mm = pose * p_mm;
    const Place at = place(images_.grid, q_mm);
    const image::BilinearPlace cell(at.column, at.row, images_.grid.width_px,
                                    images_.grid.height_px);
    const auto row = [&](const Number& read, double gz) {
      return row_of_point(
          r, p_mm, {read.derivative[0] * cells_per_mm, read.derivative[1] * cells_per_mm, gz});
    };
    const Number above_mm = read_at(cell(images_.filled_mm), at) - q_mm.z;
    equations->add_lazily(
        above_mm.value, [&]() -> Vector<6> { return row(above_mm, -1.0); }, height_weight,
        above_mm.value > 0.0 ? covering_loss : height_loss);

    const double nz = std::sqrt(
        std::max(0.0, 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny));
    const Vec3 m{p.nx, p.ny, nz};
    const auto add_normal = [&](ImageView<const float> image, const Vec3& axis) {
      const Number off = read_at(cell(image), at) - dot(axis, m);
      const auto row_of_normal = [&]() -> Vector<6> {
        Row both = row(off, 0.0);
        both.turn = both.turn - cross(m, axis);  // (2)
        return both;
      };
      equations->add_lazily(off.value, row_of_normal, normal_weight, normal_loss);
    };
    add_normal(images_.normal_x, x_axis);
    add_normal(images_.normal_y, y_axis);
  }
}

}  // namespace flatpose::refine
