#include "flatpose/refine/polish.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/refine/pose_problem.hpp"

namespace flatpose::refine {
namespace {

constexpr int kPointCountMin = 12;
constexpr int kCrossingCountMin = 6;
constexpr double kSigmaMin = 0.02;  // of the pitch: quantised scans may fit exactly
constexpr int kPatchRadiusMax_px = 3;

// The raw points of the footprint: a square patch around each surface point, as large as their
// spacing, so that nearly every point is used about once.
int patch_radius_px(const model::Template& part) noexcept {
  const double spacing_mm = std::sqrt(part.area_mm2 / std::max(1, part.surface_count));
  const double radius_px = 0.5 * (spacing_mm / part.pitch_mm - 1.0);
  return std::clamp(static_cast<int>(radius_px), 0, kPatchRadiusMax_px);
}

struct Sigmas {
  double surface_mm = 0.1;
  double contour_mm = 0.1;
};

// Sums that tell how well each kind of residual was met.
struct Fit {
  double square_sum = 0.0;
  double weight_sum = 0.0;
  [[nodiscard]] double rms() const noexcept {
    return weight_sum > 0.0 ? std::sqrt(square_sum / weight_sum) : 0.0;
  }
};

// All six parameters h = (turn, shift) in the object's frame. A measured point q of the part
// stands, in the moved frame, at q - h_r x q - h_t, so with a residual whose gradient over q is g
//   (1)  r(h) = r - g . (h_r x q + h_t) = r - (q x g) . h_r - g . h_t,
// which is linear. Contour: g is its outward normal. Surface: the residual follows the template's
// slope, but g is z alone: slopes on a flat part are rims and flanks, which sensors distort, so
// that x, y and phi are left to the contour.
class PolishProblem {
 public:
  PolishProblem(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
                const PolishConfig& config, double contour_reach_mm, const Sigmas& sigmas,
                std::span<const Crossing> crossings) noexcept
      : part_(part),
        raw_(raw),
        work_T_object_(work_T_object),
        object_T_scan_(work_T_object.inverse() * raw.work_T_scan),
        radius_px_(patch_radius_px(part)),
        surface_loss_(RobustLoss::tukey(config.height_tolerance_mm)),
        contour_loss_(RobustLoss::tukey(contour_reach_mm)),
        surface_weight_(1.0 / (sigmas.surface_mm * sigmas.surface_mm)),
        contour_variance_(sigmas.contour_mm * sigmas.contour_mm),
        crossings_(crossings) {}

  bool evaluate(const Vector<6>& h, NormalEquations<6>* equations) const noexcept {
    visit_surface([&](double r, double qx, double qy) {
      // (1) with g = z: the turn about z and the shifts along x and y have no part in it.
      equations->add_sparse<0, 1, 5>(moved_up(r, qx, qy, h), {-qy, qx, -1.0}, surface_weight_,
                                     surface_loss_);
    });
    visit_contour([&](double r, const Vec3& q, const Vec3& g, double weight) {
      add(r, q, g, h, weight, contour_loss_, equations);
    });
    if (part_.symmetry.order == model::kFullSymmetry) hold_turn(h, equations);
    return true;
  }

  [[nodiscard]] Fit surface_fit(const Vector<6>& h) const noexcept {
    Fit fit;
    visit_surface([&](double r, double qx, double qy) {
      tally(moved_up(r, qx, qy, h), surface_loss_, &fit);
    });
    return fit;
  }
  [[nodiscard]] Fit contour_fit(const Vector<6>& h) const noexcept {
    Fit fit;
    visit_contour([&](double r, const Vec3& q, const Vec3& g, double) {
      tally(moved(r, q, g, h), contour_loss_, &fit);
    });
    return fit;
  }

 private:
  static double moved(double r, const Vec3& q, const Vec3& g, const Vector<6>& h) noexcept {  // (1)
    return r - dot(cross(q, g), {h[0], h[1], h[2]}) - dot(g, {h[3], h[4], h[5]});
  }

  static double moved_up(double r, double qx, double qy, const Vector<6>& h) noexcept {  // g = z
    return r - (qy * h[0] - qx * h[1]) - h[5];
  }

  static void add(double r, const Vec3& q, const Vec3& g, const Vector<6>& h, double weight,
                  const RobustLoss& loss, NormalEquations<6>* equations) noexcept {
    const Vec3 turn = cross(q, g);
    Vector<6> row;
    row << -turn.x, -turn.y, -turn.z, -g.x, -g.y, -g.z;
    equations->add(moved(r, q, g, h), row, weight, loss);
  }

  static void tally(double r, const RobustLoss& loss, Fit* fit) noexcept {
    const double weight = loss(r).weight;
    fit->square_sum += weight * r * r;
    fit->weight_sum += weight;
  }

  // A turn that changes nothing is not fitted to the noise: about the axis of symmetry nothing may
  // turn.
  void hold_turn(const Vector<6>& h, NormalEquations<6>* equations) const noexcept {
    constexpr double kFixed = 1e12;
    equations->add_prior(2, h[2], kFixed);
  }

  template <class Visit>
  void visit_surface(Visit&& visit) const noexcept {
    for (const model::SurfacePoint& p : part_.surface_points()) {
      const Pixel centre = raw_.pixel_under(work_T_object_ * Vec3{p.x_mm, p.y_mm, p.z_mm});
      if (centre.is_none()) continue;
      const double nz2 = 1.0 - static_cast<double>(p.nx) * p.nx - static_cast<double>(p.ny) * p.ny;
      const double nz = std::sqrt(std::max(0.25, nz2));
      const Vec3 slope{p.nx / nz, p.ny / nz, 1.0};
      const Vec3 p_mm{p.x_mm, p.y_mm, p.z_mm};
      const int row_end = std::min(centre.row + radius_px_ + 1, raw_.scan.height_px);
      const int column_end = std::min(centre.column + radius_px_ + 1, raw_.scan.width_px);
      for (int row = std::max(centre.row - radius_px_, 0); row < row_end; ++row) {
        for (int column = std::max(centre.column - radius_px_, 0); column < column_end; ++column) {
          const Vec3 q_scan_mm = raw_.scan(column, row);
          if (!is_valid(q_scan_mm)) continue;
          const Vec3 q = object_T_scan_ * q_scan_mm;
          visit(dot(slope, q - p_mm), q.x, q.y);
        }
      }
    }
  }

  template <class Visit>
  void visit_contour(Visit&& visit) const noexcept {
    for (int i = 0; i < part_.contour_count; ++i) {
      if (!crossings_[i].found) continue;
      const model::ContourPoint& p = part_.contour[i];
      const double spread2 = static_cast<double>(p.spread_mm) * p.spread_mm +
                             0.25 * crossings_[i].width_mm * crossings_[i].width_mm;
      visit(crossings_[i].offset_mm, Vec3{p.x_mm, p.y_mm, p.z_mm}, Vec3{p.nx, p.ny, 0.0},
            1.0 / (contour_variance_ + spread2));
    }
  }

  const model::Template& part_;
  const RawScan& raw_;
  const Pose& work_T_object_;
  Pose object_T_scan_;
  int radius_px_;
  RobustLoss surface_loss_;
  RobustLoss contour_loss_;
  double surface_weight_;
  double contour_variance_;
  std::span<const Crossing> crossings_;
};

int measure(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
            const PolishConfig& config, std::span<Crossing> crossings) noexcept {
  const RawContourConfig contour_config{config.search_mm, config.height_tolerance_mm};
  int found_count = 0;
  for (int i = 0; i < part.contour_count; ++i) {
    crossings[i] = {};
    if (part.contour[i].spread_mm < 0.0F) continue;
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

Matrix<6> covariance_seen_from(const Matrix<6>& covariance, const Pose& first_T_other) noexcept {
  const Rotation back = first_T_other.rotation.inverse();
  const Vec3& s = first_T_other.position_mm;
  // h_r x s = S h_r
  const Rotation cross_s{{0, s.z, -s.y, -s.z, 0, s.x, s.y, -s.x, 0}};
  const Rotation turn_to_shift = back * cross_s;
  Matrix<6> a = Matrix<6>::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      a(i, j) = back.m[3 * i + j];
      a(3 + i, 3 + j) = back.m[3 * i + j];
      a(3 + i, j) = turn_to_shift.m[3 * i + j];
    }
  }
  // a C a^T, summed in a fixed order.
  Matrix<6> out = Matrix<6>::Zero();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k)
        for (int l = 0; l < 6; ++l) out(i, j) += a(i, k) * covariance(k, l) * a(j, l);
  return out;
}

Result<PolishResult> polish(const model::Template& part, const RawScan& raw,
                            const Pose& work_T_object, const PolishConfig& config,
                            std::span<Crossing> crossings) noexcept {
  if (crossings.size() < static_cast<std::size_t>(part.contour_count))
    return Status::kShapeMismatch;
  PolishResult out;
  out.work_T_object = work_T_object;
  Sigmas sigmas{part.noise_mm, 0.5 * part.pitch_mm};
  for (int round = 0; round < config.round_count; ++round) {
    out.crossing_count = measure(part, raw, out.work_T_object, config, crossings);
    // The reach shrinks with the rounds: wide to come home, narrow to shut out what is not ours.
    const double reach_mm = std::max(config.search_mm / (round + 1), 1.5 * part.pitch_mm);
    const PolishProblem problem(part, raw, out.work_T_object, config, reach_mm, sigmas, crossings);
    const auto minimum = minimize<6>(problem, Vector<6>(Vector<6>::Zero()), solver_config());
    const Fit surface = problem.surface_fit(minimum.x);
    const Fit contour = problem.contour_fit(minimum.x);
    if (surface.weight_sum < kPointCountMin || contour.weight_sum < kCrossingCountMin)
      return Status::kTooFewPoints;
    out.work_T_object = moved(out.work_T_object, minimum.x);
    out.surface_rms_mm = surface.rms();
    out.edge_rms_mm = contour.rms();
    // What was met so well is weighed so: the next round's Hessian is then one over the covariance.
    sigmas.surface_mm = std::max(surface.rms(), kSigmaMin * part.pitch_mm);
    sigmas.contour_mm = std::max(contour.rms(), kSigmaMin * part.pitch_mm);
    if (const auto c = covariance<6>(minimum.hessian))
      std::copy_n(c->matrix.data(), out.covariance.size(), out.covariance.begin());
  }
  out.turn_is_free = part.symmetry.order == model::kFullSymmetry;
  return out;
}

}  // namespace flatpose::refine
