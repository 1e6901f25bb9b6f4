#include "port/linux/tool/work_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "flatpose/core/maths.hpp"

namespace flatpose::tool {
namespace {

using Points = std::span<const Vec3>;

constexpr int kPointsMin = 30;
constexpr int kHypothesesPerLook = 50;
constexpr std::size_t kHypothesisPoints = 4000;  // that a hypothesis is judged by
constexpr std::size_t kFitPoints = 200'000;      // that the last plane is fitted to
constexpr int kHypotheses = 3000;
constexpr int kFitSteps = 30;
constexpr double kInlierShareMin = 0.03;
constexpr double kBelowShareFree = 0.01;  // false echoes lie anywhere
constexpr double kBelowWeight = 3.0;

// z = a x + b y + c about a middle, in a frame whose z is up.
struct Plane {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;

  [[nodiscard]] double above_mm(const Vec3& p) const noexcept {
    return (p.z - a * p.x - b * p.y - c) / std::sqrt(1.0 + a * a + b * b);
  }
};

/// splitmix64 (Steele, Lea and Flood 2014), from a fixed seed.
class Random {
 public:
  std::size_t index(std::size_t count) noexcept {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<std::size_t>((z ^ (z >> 31)) % count);
  }

 private:
  std::uint64_t state_ = 2015;
};

// So many at most: one of every few pixels, with no fewer than `count_max`.
std::size_t sample_size(std::size_t pixel_count, std::size_t count_max) noexcept {
  const std::size_t stride = std::max<std::size_t>(1, pixel_count / count_max);
  return (pixel_count + stride - 1) / stride;
}

// Valid points with z up: one at random of every few pixels, so that no rhythm of the rows
// matters.  Returns those there are of `room`.
std::span<Vec3> sample(const RangeImageView& scan, int up_sign, std::size_t count_max,
                       std::span<Vec3> room) noexcept {
  const std::size_t size = scan.size();
  const std::size_t stride = std::max<std::size_t>(1, size / count_max);
  std::size_t count = 0;
  Random random;
  for (std::size_t start = 0; start < size; start += stride) {
    const std::size_t pixel = std::min(start + random.index(stride), size - 1);
    const auto width = static_cast<std::size_t>(scan.width_px);
    const Vec3 p = scan(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
    if (is_valid(p)) room[count++] = {p.x, p.y, up_sign * p.z};
  }
  return room.first(count);
}

std::optional<Plane> through(const Vec3& p, const Vec3& q, const Vec3& r) noexcept {
  constexpr double kUpMin = 0.5;  // 60 degrees
  const Vec3 n = cross(q - p, r - p);
  const double length = norm(n);
  if (!(length > 0.0) || !(std::fabs(n.z) > kUpMin * length)) return {};
  Plane plane{-n.x / n.z, -n.y / n.z, 0.0};
  plane.c = p.z - plane.a * p.x - plane.b * p.y;
  return plane;
}

double worth(Points points, const Plane& plane, double tolerance_mm) noexcept {
  std::size_t on = 0;
  std::size_t below = 0;
  for (const Vec3& p : points) {
    const double above_mm = plane.above_mm(p);
    on += std::fabs(above_mm) <= tolerance_mm ? 1 : 0;
    below += above_mm < -3.0 * tolerance_mm ? 1 : 0;
  }
  const double count = static_cast<double>(points.size());
  const double excess = std::max(0.0, static_cast<double>(below) - kBelowShareFree * count);
  return static_cast<double>(on) - kBelowWeight * excess;
}

Result<Plane> best_hypothesis(Points points, double tolerance_mm, const Budget& budget) noexcept {
  std::optional<Plane> best;
  double best_worth = kInlierShareMin * static_cast<double>(points.size());
  Random random;
  for (int i = 0; i < kHypotheses; ++i) {
    if (i % kHypothesesPerLook == 0 && budget.is_over()) return Status::kStopped;
    const Vec3& p = points[random.index(points.size())];
    const Vec3& q = points[random.index(points.size())];
    const Vec3& r = points[random.index(points.size())];
    const std::optional<Plane> plane = through(p, q, r);
    if (!plane) continue;
    const double value = worth(points, *plane, tolerance_mm);
    if (value <= best_worth) continue;
    best = plane;
    best_worth = value;
  }
  return best ? Result<Plane>(*best) : Status::kTooFewPoints;
}

// The symmetric 3 x 3 system of weighted least squares, by Cramer's rule about the points' middle.
std::optional<Plane> weighted_fit(Points points, const Plane& from, double reach_mm) noexcept {
  double w_sum = 0, x_sum = 0, y_sum = 0, z_sum = 0;
  const auto weight = [&](const Vec3& p) {
    const double u = from.above_mm(p) / reach_mm;
    return std::fabs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
  };
  for (const Vec3& p : points) {
    const double w = weight(p);
    w_sum += w;
    x_sum += w * p.x;
    y_sum += w * p.y;
    z_sum += w * p.z;
  }
  if (!(w_sum > 0.0)) return {};
  const Vec3 middle{x_sum / w_sum, y_sum / w_sum, z_sum / w_sum};
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  for (const Vec3& p : points) {
    const double w = weight(p);
    const Vec3 d = p - middle;
    xx += w * d.x * d.x;
    xy += w * d.x * d.y;
    yy += w * d.y * d.y;
    xz += w * d.x * d.z;
    yz += w * d.y * d.z;
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-9 * xx * yy)) return {};  // all on one line
  Plane plane{(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant, 0.0};
  plane.c = middle.z - plane.a * middle.x - plane.b * middle.y;
  return plane;
}

// Tukey's biweight with a reach from the residuals' own spread, never wider than it began.
Result<Plane> settle(Points points, Plane plane, double tolerance_mm, std::span<double> off_mm,
                     const Budget& budget) noexcept {
  double reach_mm = 2.0 * tolerance_mm;
  for (int step = 0; step < kFitSteps; ++step) {
    if (budget.is_over()) return Status::kStopped;
    const std::optional<Plane> next = weighted_fit(points, plane, reach_mm);
    if (!next) return Status::kTooFewPoints;
    const bool is_still = std::fabs(next->a - plane.a) < 1e-12 &&
                          std::fabs(next->b - plane.b) < 1e-12 &&
                          std::fabs(next->c - plane.c) < 1e-9;
    plane = *next;
    if (is_still) break;
    std::size_t count = 0;
    for (const Vec3& p : points) {
      const double off = std::fabs(plane.above_mm(p));
      if (off < 2.0 * tolerance_mm) off_mm[count++] = off;
    }
    if (count == 0) return Status::kTooFewPoints;
    const auto begin = off_mm.begin();
    const auto middle = begin + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(count));
    constexpr double kSigmaPerMedian = 1.4826;
    constexpr double kTukey = 4.685;
    reach_mm =
        std::clamp(kTukey * kSigmaPerMedian * *middle, 0.1 * tolerance_mm, 2.0 * tolerance_mm);
  }
  return plane;
}

Pose work_frame(const Plane& plane, const Vec3& middle_mm, int up_sign) noexcept {
  const Vec3 n_up = normalized({-plane.a, -plane.b, 1.0});
  const Vec3 normal{n_up.x, n_up.y, up_sign * n_up.z};
  const Vec3 origin_mm{middle_mm.x, middle_mm.y,
                       up_sign * (plane.a * middle_mm.x + plane.b * middle_mm.y + plane.c)};
  const Pose scan_T_work{rotation_from_z_and_x(normal, {1, 0, 0}), origin_mm};
  return scan_T_work.inverse();
}

// The middle of all that is valid, and how well the plane carries it.
void measure(const RangeImageView& scan, int up_sign, const Plane& plane, double tolerance_mm,
             WorkPlane& found) noexcept {
  Vec3 low{1e9, 1e9, 0.0};
  Vec3 high{-1e9, -1e9, 0.0};
  std::int64_t valid_count = 0;
  double square_sum = 0.0;
  for (int row = 0; row < scan.height_px; ++row) {
    for (int column = 0; column < scan.width_px; ++column) {
      const Vec3 p = scan(column, row);
      if (!is_valid(p)) continue;
      ++valid_count;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), 0.0};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), 0.0};
      const double off_mm = plane.above_mm({p.x, p.y, up_sign * p.z});
      if (std::fabs(off_mm) > tolerance_mm) continue;
      ++found.inlier_count;
      square_sum += off_mm * off_mm;
    }
  }
  const double inliers = static_cast<double>(std::max<std::int64_t>(1, found.inlier_count));
  found.rms_mm = std::sqrt(square_sum / inliers);
  found.inlier_share = static_cast<double>(found.inlier_count) /
                       static_cast<double>(std::max<std::int64_t>(1, valid_count));
  found.work_T_scan = work_frame(plane, 0.5 * (low + high), up_sign);
  std::size_t corner = 0;
  for (const double x : {low.x, high.x})
    for (const double y : {low.y, high.y})
      found.corner_scan_mm[corner++] = {x, y, up_sign * (plane.a * x + plane.b * y + plane.c)};
  found.tilt_rad = arc_cosine(1.0 / std::sqrt(1.0 + plane.a * plane.a + plane.b * plane.b));
}

struct Scratch {
  std::span<Vec3> points;
  std::span<double> off_mm;
};

Scratch take_scratch(Arena& arena, std::size_t pixel_count) noexcept {
  const std::size_t count =
      std::max(sample_size(pixel_count, kHypothesisPoints), sample_size(pixel_count, kFitPoints));
  return {arena.take<Vec3>(count), arena.take<double>(count)};
}

}  // namespace

std::size_t work_plane_bytes(std::size_t pixel_count) noexcept {
  Arena arena = Arena::measuring();
  (void)take_scratch(arena, pixel_count);
  return arena.required_bytes();
}

Result<WorkPlane> find_work_plane(const RangeImageView& scan, int up_sign, double noise_mm,
                                  double pitch_mm, Arena& arena, const Budget& budget) noexcept {
  const double tolerance_mm = std::max({4.0 * noise_mm, 0.25 * pitch_mm, 1e-3});
  const ArenaScope scope(arena);
  const Scratch scratch = take_scratch(arena, scan.size());
  if (arena.failed()) return Status::kOutOfMemory;
  const Points few = sample(scan, up_sign, kHypothesisPoints, scratch.points);
  if (few.size() < kPointsMin) return Status::kTooFewPoints;
  const Result<Plane> rough = best_hypothesis(few, tolerance_mm, budget);
  if (!rough) return rough.status();
  const Points many = sample(scan, up_sign, kFitPoints, scratch.points);
  const Result<Plane> plane = settle(many, *rough, tolerance_mm, scratch.off_mm, budget);
  if (!plane) return plane.status();
  WorkPlane found;
  measure(scan, up_sign, *plane, tolerance_mm, found);
  return found;
}

std::optional<WorkPlane> find_work_plane(const RangeImageView& scan, int up_sign, double noise_mm,
                                         double pitch_mm) {
  std::vector<std::byte> memory(work_plane_bytes(scan.size()));
  Arena arena(memory);
  const Result<WorkPlane> found =
      find_work_plane(scan, up_sign, noise_mm, pitch_mm, arena, Budget());
  return found ? std::optional(*found) : std::nullopt;
}

PlaneShift shift_of(const WorkPlane& found, const Pose& work_T_scan) noexcept {
  PlaneShift shift;
  const Pose work_T_found = work_T_scan * found.work_T_scan.inverse();
  shift.middle_mm = work_T_found.position_mm.z;
  shift.tilt_rad = arc_cosine(std::clamp(work_T_found.rotation.m[8], -1.0, 1.0));
  for (const Vec3& corner : found.corner_scan_mm)
    shift.greatest_mm = std::max(shift.greatest_mm, std::fabs((work_T_scan * corner).z));
  return shift;
}

}  // namespace flatpose::tool
