#include "flatpose/teach/sharpen.hpp"

#include <array>
#include <cmath>

namespace flatpose::teach {
namespace {

constexpr int kReachInPitches = 5;

// The contour's offset at s = 0 from those of scan lines beside it, as the constant of a parabola
// in s (the contour may be curved): a single line is off by up to half a pitch. With few lines,
// their mean.
//   (1)  minimise sum (o_k - a - b s_k - c s_k^2)^2 over a, b, c
class Parabola {
 public:
  void add(double s, double offset) noexcept {
    const double s2 = s * s;
    const std::array<double, 5> powers{1.0, s, s2, s2 * s, s2 * s2};
    for (int i = 0; i < 5; ++i) power_sum_[i] += powers[i];
    for (int i = 0; i < 3; ++i) offset_sum_[i] += powers[i] * offset;
    ++count_;
  }
  [[nodiscard]] int count() const noexcept { return count_; }

  [[nodiscard]] double at_zero() const noexcept {
    constexpr int kCountForCurve = 6;
    const auto& m = power_sum_;
    const auto& o = offset_sum_;
    // Cramer's rule on the 3 x 3 normal equations of (1).
    const double c00 = m[2] * m[4] - m[3] * m[3];
    const double c01 = m[1] * m[4] - m[2] * m[3];
    const double c02 = m[1] * m[3] - m[2] * m[2];
    const double determinant = m[0] * c00 - m[1] * c01 + m[2] * c02;
    if (count_ < kCountForCurve || !(determinant > 1e-6 * m[0] * m[2] * m[4])) return o[0] / count_;
    return (o[0] * c00 - o[1] * c01 + o[2] * c02) / determinant;
  }

 private:
  std::array<double, 5> power_sum_{};
  std::array<double, 3> offset_sum_{};
  int count_ = 0;
};

}  // namespace

void ContourMean::add(const model::Template& part, const refine::RawScan& raw,
                      const Pose& work_T_object, const refine::RawContourConfig& config) noexcept {
  for (int i = 0; i < part.contour_count; ++i) {
    const model::ContourPoint& p = part.contour[i];
    Parabola parabola;
    for (int k = -kReachInPitches; k <= kReachInPitches; ++k) {
      model::ContourPoint beside = p;
      const double along_mm = k * part.pitch_mm;
      beside.x_mm = static_cast<float>(p.x_mm - along_mm * p.ny);
      beside.y_mm = static_cast<float>(p.y_mm + along_mm * p.nx);
      const refine::Crossing crossing =
          refine::measure_crossing(raw, work_T_object, beside, config);
      if (crossing.found) parabola.add(k, crossing.offset_mm);
    }
    // Near a corner or beside something else few lines agree: the edge's own place is the better
    // guess.
    constexpr int kLineCountMin = 3;
    if (parabola.count() < kLineCountMin) continue;
    sum_mm_[i] += parabola.at_zero();
    ++count_[i];
  }
}

double ContourMean::apply(model::Template& part) noexcept {
  double square_sum = 0.0;
  int measured_count = 0;
  for (int i = 0; i < part.contour_count; ++i) {
    if (count_[i] == 0) continue;
    const double shift_mm = sum_mm_[i] / count_[i];
    model::ContourPoint& p = part.contour[i];
    p.x_mm = static_cast<float>(p.x_mm + shift_mm * p.nx);
    p.y_mm = static_cast<float>(p.y_mm + shift_mm * p.ny);
    square_sum += shift_mm * shift_mm;
    ++measured_count;
  }
  *this = {};
  return measured_count > 0 ? std::sqrt(square_sum / measured_count) : 0.0;
}

}  // namespace flatpose::teach
