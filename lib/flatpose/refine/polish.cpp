#include "flatpose/refine/polish.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/refine/pose_problem.hpp"

namespace flatpose::refine {
namespace {

constexpr int kPointCountMin = 12;
constexpr int kCrossingCountMin = 6;
constexpr int kPatchRadiusMax_px = 3;

// The raw points of the footprint: a square patch around each surface point, as large as their
// spacing, so that nearly every point is used about once.
int patch_radius_px(const model::Template& part) noexcept {
  const double spacing_mm = std::sqrt(part.area_mm2 / std::max(1, part.surface_count));
  const double radius_px = 0.5 * (spacing_mm / part.pitch_mm - 1.0);
  return std::clamp(static_cast<int>(radius_px), 0, kPatchRadiusMax_px);
}

// Parameters: shift along z, turns about x and y. A point of the part at (x, y) then stands, in the
// moved frame, at
//   z - tz - (rx y - ry x),
// so the residual against the template's height there is linear.
class SurfaceProblem {
 public:
  SurfaceProblem(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
                 double tolerance_mm) noexcept
      : part_(part),
        raw_(raw),
        work_T_object_(work_T_object),
        object_T_scan_(work_T_object.inverse() * raw.work_T_scan),
        radius_px_(patch_radius_px(part)),
        loss_(RobustLoss::tukey(tolerance_mm)) {}

  bool evaluate(const Vector<3>& x, NormalEquations<3>* equations) const noexcept {
    for (const model::SurfacePoint& p : part_.surface_points()) {
      const Pixel centre = raw_.pixel_under(work_T_object_ * Vec3{p.x_mm, p.y_mm, p.z_mm});
      if (!centre.is_none()) add_patch(p, centre, x, equations);
    }
    return true;
  }

 private:
  void add_patch(const model::SurfacePoint& p, Pixel centre, const Vector<3>& x,
                 NormalEquations<3>* equations) const noexcept {
    const double nz2 = 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny;
    const double nz = std::sqrt(std::max(0.25, nz2));
    for (int row = centre.row - radius_px_; row <= centre.row + radius_px_; ++row) {
      for (int column = centre.column - radius_px_; column <= centre.column + radius_px_;
           ++column) {
        if (!raw_.scan.contains(column, row)) continue;
        const Vec3 q_scan_mm = raw_.scan(column, row);
        if (!is_valid(q_scan_mm)) continue;
        const Vec3 q = object_T_scan_ * q_scan_mm;
        const double expected_mm = p.z_mm - (p.nx * (q.x - p.x_mm) + p.ny * (q.y - p.y_mm)) / nz;
        const double residual_mm = q.z - x[0] - (x[1] * q.y - x[2] * q.x) - expected_mm;
        equations->add(residual_mm, Vector<3>(-1.0, -q.y, q.x), 1.0, loss_);
      }
    }
  }

  const model::Template& part_;
  const RawScan& raw_;
  const Pose& work_T_object_;
  Pose object_T_scan_;
  int radius_px_;
  RobustLoss loss_;
};

// Parameters: shifts along x and y, turn about z at the centre of symmetry. A measured contour
// point moves by minus that, so offset - n . (t + turn x q) is its residual.
class ContourProblem {
 public:
  ContourProblem(const model::Template& part, std::span<const Crossing> crossings,
                 double reach_mm) noexcept
      : part_(part), crossings_(crossings), loss_(RobustLoss::tukey(reach_mm)) {}

  bool evaluate(const Vector<3>& x, NormalEquations<3>* equations) const noexcept {
    for (int i = 0; i < part_.contour_count; ++i) {
      if (!crossings_[i].found) continue;
      const model::ContourPoint& p = part_.contour[i];
      const double lever_mm = (p.x_mm - part_.symmetry.center_x_mm) * p.ny -
                              (p.y_mm - part_.symmetry.center_y_mm) * p.nx;
      const double residual_mm =
          crossings_[i].offset_mm - (x[0] * p.nx + x[1] * p.ny + x[2] * lever_mm);
      equations->add(residual_mm, Vector<3>(-p.nx, -p.ny, -lever_mm), 1.0, loss_);
    }
    // A turn that changes nothing is not fitted to the noise.
    constexpr double kFixed = 1e9;
    if (part_.symmetry.order == model::kFullSymmetry) equations->add_prior(2, x[2], kFixed);
    return true;
  }

 private:
  const model::Template& part_;
  std::span<const Crossing> crossings_;
  RobustLoss loss_;
};

// A turn by a small angle about the centre of symmetry as a step in the object's frame.
Vector<6> contour_step(const model::Symmetry& symmetry, const Vector<3>& x) noexcept {
  Vector<6> step = Vector<6>::Zero();
  step[2] = x[2];
  step[3] = x[0] + x[2] * symmetry.center_y_mm;
  step[4] = x[1] - x[2] * symmetry.center_x_mm;
  return step;
}

Vector<6> surface_step(const Vector<3>& x) noexcept {
  Vector<6> step = Vector<6>::Zero();
  step[0] = x[1];
  step[1] = x[2];
  step[5] = x[0];
  return step;
}

double variance_of(const Minimum<3, Vector<3>>& minimum) noexcept {
  const double freedom = std::max(1.0, minimum.weight_sum - 3.0);
  return minimum.square_sum / freedom;
}

double rms_of(const Minimum<3, Vector<3>>& minimum) noexcept {
  return minimum.weight_sum > 0.0 ? std::sqrt(minimum.square_sum / minimum.weight_sum) : 0.0;
}

void add_covariance(const Matrix<3>& c, const std::array<int, 3>& to, Matrix<6>* out) noexcept {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) (*out)(to[i], to[j]) = c(i, j);
}

int measure(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
            const PolishConfig& config, std::span<Crossing> crossings) noexcept {
  const RawContourConfig contour_config{config.search_mm, config.height_tolerance_mm};
  int found_count = 0;
  for (int i = 0; i < part.contour_count; ++i) {
    crossings[i] = measure_crossing(raw, work_T_object, part.contour[i], contour_config);
    if (crossings[i].found) ++found_count;
  }
  return found_count;
}

// Both problems are linear but for the losses: a few steps settle them far below what the points
// can tell.
LevenbergMarquardtConfig solver_config() noexcept {
  LevenbergMarquardtConfig config;
  config.iteration_limit = 8;
  config.gradient_tolerance = 1e-6;
  config.step_tolerance = 1e-6;
  config.cost_tolerance = 1e-6;
  return config;
}

}  // namespace

Result<PolishResult> polish(const model::Template& part, const RawScan& raw,
                            const Pose& work_T_object, const PolishConfig& config,
                            std::span<Crossing> crossings) noexcept {
  if (crossings.size() < static_cast<std::size_t>(part.contour_count))
    return Status::kShapeMismatch;
  PolishResult out;
  out.work_T_object = work_T_object;
  const Vector<3> zero = Vector<3>::Zero();
  for (int round = 0; round < config.round_count; ++round) {
    const SurfaceProblem surface(part, raw, out.work_T_object, config.height_tolerance_mm);
    const auto flat = minimize<3>(surface, zero, solver_config());
    if (flat.weight_sum < kPointCountMin) return Status::kTooFewPoints;
    out.work_T_object = moved(out.work_T_object, surface_step(flat.x));

    out.crossing_count = measure(part, raw, out.work_T_object, config, crossings);
    if (out.crossing_count < kCrossingCountMin) return Status::kTooFewPoints;
    // The reach shrinks with the rounds: wide to come home, narrow to shut out what is not ours.
    const double reach_mm = std::max(config.search_mm / (round + 1), 1.5 * part.pitch_mm);
    const ContourProblem contour(part, crossings, reach_mm);
    const auto round_trip = minimize<3>(contour, zero, solver_config());
    if (round_trip.weight_sum < kCrossingCountMin) return Status::kTooFewPoints;
    out.work_T_object = moved(out.work_T_object, contour_step(part.symmetry, round_trip.x));

    out.point_count = flat.residual_count;
    out.surface_rms_mm = rms_of(flat);
    out.edge_rms_mm = rms_of(round_trip);
    if (const auto c = covariance<3>(flat.hessian, variance_of(flat))) {
      add_covariance(c->matrix, {5, 0, 1}, &out.covariance);
    }
    if (const auto c = covariance<3>(round_trip.hessian, variance_of(round_trip))) {
      add_covariance(c->matrix, {3, 4, 2}, &out.covariance);
    }
  }
  out.turn_is_free = part.symmetry.order == model::kFullSymmetry;
  return out;
}

}  // namespace flatpose::refine
