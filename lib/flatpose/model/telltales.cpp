#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "flatpose/core/maths.hpp"
#include "flatpose/model/landmarks.hpp"

namespace flatpose::model {
namespace {

// Where a point of the mirrored contour comes to lie: mirrored in x about the middle, turned about
// it, shifted.
struct Placement {
  double turn_rad = 0.0;
  double shift_x_mm = 0.0;
  double shift_y_mm = 0.0;
};

struct Placed {
  double x_mm;
  double y_mm;
  double nx;
  double ny;
};

class MirroredSelf {
 public:
  explicit MirroredSelf(const Template& part) noexcept : part_(part) {
    for (const ContourPoint& p : part.contour_points()) {
      middle_x_mm_ += static_cast<double>(p.x_mm) / part.contour_count;
      middle_y_mm_ += static_cast<double>(p.y_mm) / part.contour_count;
    }
  }

  // The placement that leaves the fewest points without a counterpart.
  [[nodiscard]] Placement best() const noexcept {
    constexpr int kTurnCount = 180;
    constexpr int kStartCount = 4;
    constexpr std::size_t kSparseCount = 64;  // a prefix is spread over the whole contour
    const double coarse_mm = std::max(3.0 * part_.cell_mm, 0.04 * part_.radius_mm);
    std::array<int, kTurnCount> counts{};
    for (int k = 0; k < kTurnCount; ++k)
      counts[k] = counterparts({2.0 * kPi * k / kTurnCount, 0.0, 0.0}, coarse_mm, kSparseCount);
    Placement best;
    int best_count = -1;
    for (int start = 0; start < kStartCount; ++start) {
      const auto top = std::max_element(counts.begin(), counts.end());
      const int k = static_cast<int>(top - counts.begin());
      const Placement settled = settle({2.0 * kPi * k / kTurnCount, 0.0, 0.0}, 2.0 * coarse_mm);
      const int count = counterparts(settled, reach_mm(), kContourPointCountMax);
      if (count > best_count) {
        best_count = count;
        best = settled;
      }
      for (int side = -2; side <= 2; ++side) counts[(k + side + kTurnCount) % kTurnCount] = -1;
    }
    return best;
  }

  /// Where a point of the mirrored contour comes to lie.
  [[nodiscard]] Placed placed(const ContourPoint& p, const Placement& placement,
                              const SinCos& turn) const noexcept {
    const double x = middle_x_mm_ - p.x_mm;
    const double y = p.y_mm - middle_y_mm_;
    return {middle_x_mm_ + placement.shift_x_mm + turn.cos * x - turn.sin * y,
            middle_y_mm_ + placement.shift_y_mm + turn.sin * x + turn.cos * y,
            -turn.cos * p.nx - turn.sin * p.ny, -turn.sin * p.nx + turn.cos * p.ny};
  }

  /// How far off the mirrored contour is that falls the same way as the point, in cells.
  [[nodiscard]] double gap_px(std::span<const Placed> mirrored,
                              const ContourPoint& p) const noexcept {
    double gap_px = kFar_px;
    for (const Placed& q : mirrored) gap_px = std::min(gap_px, distance_px(p, q));
    return gap_px;
  }

  /// How far off the part's own contour is from a mirrored point, in cells.
  [[nodiscard]] double gap_of_mirrored_px(const Placed& q) const noexcept {
    double gap_px = kFar_px;
    for (const ContourPoint& other : part_.contour_points())
      gap_px = std::min(gap_px, distance_px(other, q));
    return gap_px;
  }

 private:
  static constexpr double kAlongShare = 2.0;
  static constexpr double kFar_px = 4.0;

  // Counterparts lie no farther apart than verification lets them agree by half.
  [[nodiscard]] double reach_mm() const noexcept { return 2.5 * part_.cell_mm; }

  // Along the contour the points lie apart; across it they must agree. As far as kFar_px.
  [[nodiscard]] double distance_px(const ContourPoint& p, const Placed& q) const noexcept {
    if (!faces_alike(p, q)) return kFar_px;
    const double across = p.nx * (q.x_mm - p.x_mm) + p.ny * (q.y_mm - p.y_mm);
    const double along = p.nx * (q.y_mm - p.y_mm) - p.ny * (q.x_mm - p.x_mm);
    const double beyond_mm = std::max(0.0, std::fabs(along) - kAlongShare * reach_mm());
    return std::min(kFar_px, std::sqrt(across * across + beyond_mm * beyond_mm) / part_.cell_mm);
  }

  static bool faces_alike(const ContourPoint& p, const Placed& q) noexcept {
    constexpr double kCosineMin = 0.8;
    return p.nx * q.nx + p.ny * q.ny >= kCosineMin;
  }

  static bool is_counterpart(const ContourPoint& p, const Placed& q, double reach_mm) noexcept {
    if (!faces_alike(p, q)) return false;
    const double dx = q.x_mm - p.x_mm;
    const double dy = q.y_mm - p.y_mm;
    return std::fabs(p.nx * dx + p.ny * dy) <= reach_mm &&
           std::fabs(p.nx * dy - p.ny * dx) <= kAlongShare * reach_mm;
  }

  [[nodiscard]] int counterparts(const Placement& placement, double reach_mm,
                                 std::size_t point_count) const noexcept {
    const SinCos turn = sin_cos(placement.turn_rad);
    const auto points = part_.contour_points();
    int count = 0;
    for (const ContourPoint& p : points.first(std::min(points.size(), point_count))) {
      const Placed q = placed(p, placement, turn);
      for (const ContourPoint& other : points) {
        if (!is_counterpart(other, q, reach_mm)) continue;
        ++count;
        break;
      }
    }
    return count;
  }

  // Least squares over the gaps to the nearest counterparts, whose reach shrinks.
  [[nodiscard]] Placement settle(Placement placement, double reach_mm) const noexcept {
    constexpr int kRoundCount = 10;
    for (int round = 0; round < kRoundCount; ++round) {
      const double reach = std::max(this->reach_mm(), reach_mm / (1 + round));
      Sums sums;
      const SinCos turn = sin_cos(placement.turn_rad);
      for (const ContourPoint& p : part_.contour_points()) add_gap(p, placement, turn, reach, sums);
      if (!sums.step(placement)) break;
    }
    return placement;
  }

  // Normal equations of the gaps over (turn, shift).
  struct Sums {
    std::array<Vec3, 3> rows{};
    Vec3 right;
    void add(const Vec3& slope, double gap) noexcept {
      rows[0] = rows[0] + slope.x * slope;
      rows[1] = rows[1] + slope.y * slope;
      rows[2] = rows[2] + slope.z * slope;
      right = right + gap * slope;
    }
    // Moves the placement by their solution, Cramer's rule in cross products; false when the
    // contour does not hold it.
    bool step(Placement& placement) const noexcept {
      const Vec3 c0 = cross(rows[1], rows[2]);
      const double determinant = dot(rows[0], c0);
      if (!(determinant > 1e-9 * rows[0].x * rows[1].y * rows[2].z)) return false;
      const Vec3 d = (1.0 / determinant) * (right.x * c0 + right.y * cross(rows[2], rows[0]) +
                                            right.z * cross(rows[0], rows[1]));
      placement.turn_rad += d.x;
      placement.shift_x_mm += d.y;
      placement.shift_y_mm += d.z;
      return true;
    }
  };

  void add_gap(const ContourPoint& p, const Placement& placement, const SinCos& turn, double reach,
               Sums& sums) const noexcept {
    const Placed q = placed(p, placement, turn);
    const ContourPoint* nearest = nullptr;
    double nearest2 = 0.0;
    for (const ContourPoint& other : part_.contour_points()) {
      if (!is_counterpart(other, q, reach)) continue;
      const double dx = other.x_mm - q.x_mm;
      const double dy = other.y_mm - q.y_mm;
      if (nearest != nullptr && dx * dx + dy * dy >= nearest2) continue;
      nearest = &other;
      nearest2 = dx * dx + dy * dy;
    }
    if (nearest == nullptr) return;
    const double gap =
        nearest->nx * (nearest->x_mm - q.x_mm) + nearest->ny * (nearest->y_mm - q.y_mm);
    // A turn moves the point across its lever arm from the turn's centre.
    const double rx = q.x_mm - middle_x_mm_ - placement.shift_x_mm;
    const double ry = q.y_mm - middle_y_mm_ - placement.shift_y_mm;
    sums.add({nearest->ny * rx - nearest->nx * ry, nearest->nx, nearest->ny}, gap);
  }

  const Template& part_;
  double middle_x_mm_ = 0.0;
  double middle_y_mm_ = 0.0;
};

}  // namespace

void find_telltales(const Template& part, Landmarks& out) noexcept {
  const MirroredSelf mirrored(part);
  const Placement placement = mirrored.best();
  // Nearer than this, an edge a fraction of a cell off decides.
  const SinCos turn = sin_cos(placement.turn_rad);
  std::array<Placed, kContourPointCountMax> all;
  for (int i = 0; i < part.contour_count; ++i)
    all[i] = mirrored.placed(part.contour[i], placement, turn);
  const auto placed = std::span<const Placed>(all).first(part.contour_points().size());
  for (int i = 0; i < part.contour_count; ++i) {
    const ContourPoint& p = part.contour[i];
    const double gap_px = mirrored.gap_px(placed, p);
    if (gap_px >= kTelltaleGapMin_px) {
      out.telltale_gap_px[i] = static_cast<float>(gap_px);
      ++out.telltale_count;
    }
    const Placed& q = placed[i];
    const double mirrored_gap_px = mirrored.gap_of_mirrored_px(q);
    if (mirrored_gap_px < kTelltaleGapMin_px || out.mirrored_count == kMirroredCountMax) continue;
    ContourPoint& shown = out.mirrored[out.mirrored_count];
    shown = p;
    shown.x_mm = static_cast<float>(q.x_mm);
    shown.y_mm = static_cast<float>(q.y_mm);
    shown.nx = static_cast<float>(q.nx);
    shown.ny = static_cast<float>(q.ny);
    out.mirrored_gap_px[out.mirrored_count++] = static_cast<float>(mirrored_gap_px);
  }
}

Landmarks find_landmarks(const Template& part) noexcept {
  Landmarks out;
  find_holes(part, out);
  find_telltales(part, out);
  return out;
}

}  // namespace flatpose::model
