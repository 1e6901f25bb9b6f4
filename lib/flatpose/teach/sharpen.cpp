#include "flatpose/teach/sharpen.hpp"

#include <cmath>

namespace flatpose::teach {
namespace {

// How much the offset measured at q says about the contour at p: near, and facing the same way.
double kinship(const model::ContourPoint& p, const model::ContourPoint& q,
               double reach_mm) noexcept {
  constexpr double kCosineMin = 0.95;
  const double cosine = static_cast<double>(p.nx) * q.nx + static_cast<double>(p.ny) * q.ny;
  if (cosine < kCosineMin) return 0.0;
  const double dx = static_cast<double>(p.x_mm) - q.x_mm;
  const double dy = static_cast<double>(p.y_mm) - q.y_mm;
  // Only along the contour: the parallel side of a thin wall faces the same way too.
  const double across = dx * p.nx + dy * p.ny;
  const double share = (dx * dx + dy * dy) / (reach_mm * reach_mm);
  return share < 1.0 && std::fabs(across) < 0.5 * reach_mm ? 1.0 - share : 0.0;
}

}  // namespace

void ContourMean::add(const model::Template& part, const refine::RawScan& raw,
                      const Pose& work_T_object, const refine::RawContourConfig& config) noexcept {
  for (int i = 0; i < part.contour_count; ++i) {
    const refine::Crossing crossing =
        refine::measure_crossing(raw, work_T_object, part.contour[i], config);
    if (!crossing.found) continue;
    sum_mm_[i] += crossing.offset_mm;
    ++count_[i];
  }
}

double ContourMean::apply(double reach_mm, model::Template& part) noexcept {
  std::array<double, model::kContourPointCountMax> shift_mm{};
  double square_sum = 0.0;
  int measured_count = 0;
  for (int i = 0; i < part.contour_count; ++i) {
    double weight_sum = 0.0;
    for (int j = 0; j < part.contour_count; ++j) {
      if (count_[j] == 0) continue;
      const double weight = kinship(part.contour[i], part.contour[j], reach_mm);
      shift_mm[i] += weight * sum_mm_[j];
      weight_sum += weight * count_[j];
    }
    if (weight_sum > 0.0) shift_mm[i] /= weight_sum;
    if (count_[i] == 0) continue;
    const double rest_mm = sum_mm_[i] / count_[i] - shift_mm[i];
    square_sum += rest_mm * rest_mm;
    ++measured_count;
  }
  for (int i = 0; i < part.contour_count; ++i) {
    model::ContourPoint& p = part.contour[i];
    p.x_mm = static_cast<float>(p.x_mm + shift_mm[i] * p.nx);
    p.y_mm = static_cast<float>(p.y_mm + shift_mm[i] * p.ny);
  }
  *this = {};
  return measured_count > 0 ? std::sqrt(square_sum / measured_count) : 0.0;
}

}  // namespace flatpose::teach
