#include "flatpose/refine/polish.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/refine/pose_problem.hpp"
#include "flatpose/refine/surface_sums.hpp"

namespace flatpose::refine {
namespace {

constexpr int kPointCountMin = 12;
constexpr int kCrossingCountMin = 6;
constexpr double kSigmaMin = 0.02;  // of the pitch: quantised scans may fit exactly
// Rounds before the last need no more of the contour and the surface than this to come home.
constexpr int kContourToComeHome = 160;
constexpr int kCrossingsToComeHome = 60;
constexpr int kPointsToComeHome = 500;

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
  PolishProblem(const model::Template& part, const PolishConfig& config, double contour_reach_mm,
                const Sigmas& sigmas, const PolishScratch& scratch) noexcept
      : part_(part),
        sum_surface_(sum_surface_for(config.vector_path)),
        surface_reach_mm_(config.height_tolerance_mm),
        contour_loss_(RobustLoss::tukey(contour_reach_mm)),
        surface_weight_(1.0 / (sigmas.surface_mm * sigmas.surface_mm)),
        contour_variance_(sigmas.contour_mm * sigmas.contour_mm),
        scratch_(scratch) {}

  bool evaluate(const Vector<6>& h, NormalEquations<6>* equations) const noexcept {
    add_surface(h, equations);
    visit_contour([&](double r, const Vec3& q, const Vec3& g, double weight) {
      const Vec3 turn = cross(q, g);
      Vector<6> row;
      row << -turn.x, -turn.y, -turn.z, -g.x, -g.y, -g.z;
      equations->add(moved(r, q, g, h), row, weight, contour_loss_);
    });
    if (part_.symmetry.order == model::kFullSymmetry) hold_turn(h, equations);
    return true;
  }

  /// What the scan tells about h: one over the covariance. `hessian` is evaluate()'s there, in
  /// which a robust loss makes the surface look surer than it is: weighing down the far points of
  /// plain noise lowers the rms that the rest is weighed by. With psi = r w(r), points tell
  ///   (2)  (sum psi')^2 / sum psi^2   instead of   sum w / rms^2         (Huber 1981, 6.3).
  [[nodiscard]] Matrix<6> information(const Vector<6>& h, const Matrix<6>& hessian) const noexcept {
    NormalEquations<6> surface;
    add_surface(h, &surface);
    const double told_too_much = 1.0 - surface_efficiency(h);
    Matrix<6> out = hessian;
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) out(i, j) -= told_too_much * surface.hessian(i, j);
    return out;
  }

  [[nodiscard]] Fit surface_fit(const Vector<6>& h) const noexcept {
    const SurfaceSums s = surface_sums(h);
    return {s.wrr, s.w};
  }
  [[nodiscard]] Fit contour_fit(const Vector<6>& h) const noexcept {
    Fit fit;
    visit_contour([&](double r, const Vec3& q, const Vec3& g, double) {
      const double at_h = moved(r, q, g, h);
      const double weight = contour_loss_(at_h).weight;
      fit.square_sum += weight * at_h * at_h;
      fit.weight_sum += weight;
    });
    return fit;
  }

 private:
  static double moved(double r, const Vec3& q, const Vec3& g, const Vector<6>& h) noexcept {  // (1)
    return r - dot(cross(q, g), {h[0], h[1], h[2]}) - dot(g, {h[3], h[4], h[5]});
  }

  [[nodiscard]] SurfaceSums surface_sums(const Vector<6>& h) const noexcept {
    SurfaceSums sums;
    sum_surface_(scratch_.footprint, {h[0], h[1], h[5]}, surface_reach_mm_, sums);
    return sums;
  }

  // The quotient of the two sides of (2), from every few points: they are many.
  [[nodiscard]] double surface_efficiency(const Vector<6>& h) const noexcept {
    constexpr int kStride = 4;
    const Footprint& f = scratch_.footprint;
    double weight = 0.0;
    double slope = 0.0;
    double psi2 = 0.0;
    for (int i = 0; i < f.count; i += kStride) {
      const double r = f.above_mm[i] - (f.y_mm[i] * h[0] - f.x_mm[i] * h[1]) - h[5];
      const double share = r * r / (surface_reach_mm_ * surface_reach_mm_);
      if (share >= 1.0) continue;
      const double u = 1.0 - share;
      weight += u * u;
      slope += u * (5.0 * u - 4.0);  // psi'
      psi2 += r * r * u * u * u * u;
    }
    const double told = surface_weight_ * weight * psi2;
    return told > slope * slope ? std::max(slope, 0.0) * slope / told : 1.0;
  }

  // (1) with g = z: a row is (-y, x, -1) for the turns about x and y and the shift along z.
  void add_surface(const Vector<6>& h, NormalEquations<6>* equations) const noexcept {
    const SurfaceSums s = surface_sums(h);
    const double weight = surface_weight_;
    SparseSums<3> sums;
    sums.residual_count = scratch_.footprint.count;
    sums.cost = weight * surface_reach_mm_ * surface_reach_mm_ / 6.0 * (sums.residual_count - s.u3);
    sums.square_sum = weight * s.wrr;
    sums.weight_sum = weight * s.w;
    sums.gradient = {-weight * s.wry, weight * s.wrx, -weight * s.wr};
    sums.hessian_lower = {{{weight * s.wyy, 0.0, 0.0},
                           {-weight * s.wxy, weight * s.wxx, 0.0},
                           {weight * s.wy, -weight * s.wx, weight * s.w}}};
    equations->add_summed<0, 1, 5>(sums);
  }

  // A turn that changes nothing is not fitted to the noise: about the axis of symmetry nothing may
  // turn.
  void hold_turn(const Vector<6>& h, NormalEquations<6>* equations) const noexcept {
    constexpr double kFixed = 1e12;
    equations->add_prior(2, h[2], kFixed);
  }

  template <class Visit>
  void visit_contour(Visit&& visit) const noexcept {
    for (int i = 0; i < part_.contour_count; ++i) {
      const Crossing& crossing = scratch_.crossings[i];
      if (!crossing.found) continue;
      const model::ContourPoint& p = part_.contour[i];
      const double spread2 = static_cast<double>(p.spread_mm) * p.spread_mm +
                             0.25 * crossing.width_mm * crossing.width_mm;
      visit(crossing.offset_mm, Vec3{p.x_mm, p.y_mm, p.z_mm}, Vec3{p.nx, p.ny, 0.0},
            1.0 / (contour_variance_ + spread2));
    }
  }

  const model::Template& part_;
  SumSurface sum_surface_;
  double surface_reach_mm_;
  RobustLoss contour_loss_;
  double surface_weight_;
  double contour_variance_;
  const PolishScratch& scratch_;
};

// What a round measures at a pose: the scan's points under the part, and where its lines leave it.
class Measurement {
 public:
  Measurement(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
              const PolishConfig& config, PolishScratch& scratch) noexcept
      : part_(part), raw_(raw), work_T_object_(work_T_object), config_(config), scratch_(scratch) {}

  /// Returns how many crossings were found; none of them means anything when the budget is over.
  /// `part_only`: of a first part of the contour, whose points are in an order in which any first
  /// ones are spread well, and of a quarter of the points.
  int measure(bool part_only, const Budget& budget) noexcept {
    part_only_ = part_only;
    count_ = part_only ? std::min(part_.contour_count, kContourToComeHome) : part_.contour_count;
    if (!for_each_chunk(budget, 1 + kContourChunkCount, *this)) return 0;
    std::fill(scratch_.crossings.begin() + count_, scratch_.crossings.begin() + part_.contour_count,
              Crossing{});
    return static_cast<int>(std::count_if(scratch_.crossings.begin(),
                                          scratch_.crossings.begin() + count_,
                                          [](const Crossing& c) { return c.found; }));
  }
  /// A chunk of the work: the surface, or a share of the contour.
  void operator()(int chunk) noexcept {
    if (chunk == 0) {
      gather(part_, raw_, work_T_object_, part_only_, scratch_.footprint);
    } else {
      cross((chunk - 1) * count_ / kContourChunkCount, chunk * count_ / kContourChunkCount);
    }
  }

 private:
  static constexpr int kContourChunkCount = 4;

  void cross(int begin, int end) noexcept {
    const RawContourConfig config{config_.search_mm, config_.height_tolerance_mm};
    for (int i = begin; i < end; ++i) {
      const model::ContourPoint& p = part_.contour[i];
      scratch_.crossings[i] =
          p.spread_mm < 0.0F ? Crossing{} : measure_crossing(raw_, work_T_object_, p, config);
    }
  }

  const model::Template& part_;
  const RawScan& raw_;
  const Pose& work_T_object_;
  const PolishConfig& config_;
  PolishScratch& scratch_;
  bool part_only_ = false;
  int count_ = 0;
};

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

PolishScratch take_polish_scratch(Arena& arena) noexcept {
  return {arena.take<Crossing>(model::kContourPointCountMax), take_footprint(arena)};
}

Result<PolishResult> polish(const model::Template& part, const RawScan& raw,
                            const Pose& work_T_object, const PolishConfig& config,
                            PolishScratch& scratch, const Budget& budget) noexcept {
  PolishResult out;
  out.work_T_object = work_T_object;
  Sigmas sigmas{part.noise_mm, 0.5 * part.pitch_mm};
  for (int round = 0; round < config.round_count; ++round) {
    const bool is_last = round + 1 == config.round_count;
    Measurement measurement(part, raw, out.work_T_object, config, scratch);
    out.crossing_count = measurement.measure(!is_last, budget);
    const bool is_enough =
        out.crossing_count >= kCrossingsToComeHome && scratch.footprint.count >= kPointsToComeHome;
    if (!is_last && !is_enough) out.crossing_count = measurement.measure(false, budget);
    if (budget.was_over()) return Status::kStopped;
    // The reach shrinks with the rounds: wide to come home, narrow to shut out what is not ours.
    const double reach_mm = std::max(config.search_mm / (round + 1), 1.5 * part.pitch_mm);
    const PolishProblem problem(part, config, reach_mm, sigmas, scratch);
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
    if (!is_last) continue;
    if (const auto c = covariance<6>(problem.information(minimum.x, minimum.hessian)))
      std::copy_n(c->matrix.data(), out.covariance.size(), out.covariance.begin());
  }
  out.turn_is_free = part.symmetry.order == model::kFullSymmetry;
  return out;
}

}  // namespace flatpose::refine
