#include "flatpose/teach/surface_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/core/sort.hpp"
#include "flatpose/refine/levenberg_marquardt.hpp"

namespace flatpose::teach {
namespace {

template <class Value>
double median_of(std::span<const SurfaceSample> samples, std::span<double> scratch,
                 Value&& value) noexcept {
  for (std::size_t i = 0; i < samples.size(); ++i) scratch[i] = value(samples[i]);
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(scratch.begin(), middle,
                   scratch.begin() + static_cast<std::ptrdiff_t>(samples.size()));
  return *middle;
}

// The middle of the window of width 2 tolerance that holds the most offsets.
double densest_offset(std::span<const SurfaceSample> samples, const Plane& plane,
                      double tolerance_mm, std::span<double> scratch) noexcept {
  const std::size_t count = samples.size();
  for (std::size_t i = 0; i < count; ++i) {
    scratch[i] =
        samples[i].z_mm - plane.slope_x * samples[i].x_mm - plane.slope_y * samples[i].y_mm;
  }
  sort_in_place(scratch.first(count), [](double a, double b) { return a < b; });
  std::size_t best_begin = 0;
  std::size_t best_end = 0;
  for (std::size_t begin = 0, end = 0; end < count; ++end) {
    while (scratch[end] - scratch[begin] > 2.0 * tolerance_mm) ++begin;
    if (end - begin > best_end - best_begin) {
      best_begin = begin;
      best_end = end;
    }
  }
  return scratch[(best_begin + best_end) / 2];
}

class PlaneProblem {
 public:
  PlaneProblem(std::span<const SurfaceSample> samples, double tolerance_mm,
               const Vec3& middle_mm) noexcept
      : samples_(samples), middle_mm_(middle_mm), loss_(refine::RobustLoss::tukey(tolerance_mm)) {}

  bool evaluate(const refine::Vector<3>& x, refine::NormalEquations<3>* equations) const noexcept {
    for (const SurfaceSample& s : samples_) {
      const double dx = s.x_mm - middle_mm_.x;
      const double dy = s.y_mm - middle_mm_.y;
      equations->add(s.z_mm - (x[0] + x[1] * dx + x[2] * dy), refine::Vector<3>(-1.0, -dx, -dy),
                     1.0, loss_);
    }
    return true;
  }

 private:
  std::span<const SurfaceSample> samples_;
  Vec3 middle_mm_;
  refine::RobustLoss loss_;
};

// The plane at the densest offset, by least squares over what lies within the reach of it.
Plane settled(std::span<const SurfaceSample> samples, Plane plane, double reach_mm,
              const Vec3& middle_mm, std::span<double> scratch) noexcept {
  plane.offset_mm = densest_offset(samples, plane, reach_mm, scratch);
  const refine::Vector<3> start(plane.z_at(middle_mm.x, middle_mm.y), plane.slope_x, plane.slope_y);
  const auto fit = refine::minimize<3>(PlaneProblem(samples, reach_mm, middle_mm), start);
  plane.slope_x = fit.x[1];
  plane.slope_y = fit.x[2];
  plane.offset_mm = fit.x[0] - fit.x[1] * middle_mm.x - fit.x[2] * middle_mm.y;
  return plane;
}

// How much lies on the plane, what lies on it closely counting most: an oblique plane across two
// levels comes near to many samples, and to few of them closely.
double support_of(std::span<const SurfaceSample> samples, const Plane& plane,
                  double tolerance_mm) noexcept {
  double sum = 0.0;
  for (const SurfaceSample& s : samples) {
    const double share = (s.z_mm - plane.z_at(s.x_mm, s.y_mm)) / tolerance_mm;
    const double u = std::max(0.0, 1.0 - share * share);
    sum += u * u;
  }
  return sum;
}

}  // namespace

Plane dominant_plane(std::span<const SurfaceSample> samples, double tolerance_mm,
                     std::span<double> scratch) noexcept {
  Plane start;
  start.slope_x = median_of(samples, scratch, [](const SurfaceSample& s) { return s.slope_x; });
  start.slope_y = median_of(samples, scratch, [](const SurfaceSample& s) { return s.slope_y; });
  Vec3 middle_mm;
  middle_mm.x = median_of(samples, scratch, [](const SurfaceSample& s) { return s.x_mm; });
  middle_mm.y = median_of(samples, scratch, [](const SurfaceSample& s) { return s.y_mm; });
  // The slopes' error tilts the far ends apart: a wide window finds the plane, narrower ones settle
  // it. But a wide one may lay a plane across two levels, which no narrower one undoes: so from
  // every width, and what most samples lie on is the plane.
  constexpr std::array<double, 4> kWidenings{6.0, 3.0, 2.0, 1.0};
  Plane best;
  double best_support = -1.0;
  for (std::size_t first = 0; first < kWidenings.size(); ++first) {
    Plane plane = start;
    for (std::size_t k = first; k < kWidenings.size(); ++k)
      plane = settled(samples, plane, kWidenings[k] * tolerance_mm, middle_mm, scratch);
    const double support = support_of(samples, plane, tolerance_mm);
    if (!(support > best_support)) continue;
    best = plane;
    best_support = support;
  }
  return best;
}

}  // namespace flatpose::teach
