#include "flatpose/teach/sharpen.hpp"

#include <algorithm>
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
    square_sum_ += offset * offset;
    ++count_;
  }
  [[nodiscard]] int count() const noexcept { return count_; }

  struct Fit {
    double at_zero = 0.0;
    double rms = 0.0;
  };
  [[nodiscard]] Fit fit() const noexcept {
    constexpr int kCountForCurve = 6;
    const auto& m = power_sum_;
    const auto& o = offset_sum_;
    // Cramer's rule on the 3 x 3 normal equations of (1); their matrix is symmetric.
    const double c00 = m[2] * m[4] - m[3] * m[3];
    const double c01 = m[2] * m[3] - m[1] * m[4];
    const double c02 = m[1] * m[3] - m[2] * m[2];
    const double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02;
    if (count_ < kCountForCurve || !(determinant > 1e-6 * m[0] * m[2] * m[4])) {
      const double mean = o[0] / count_;
      return {mean, std::sqrt(std::max(0.0, square_sum_ / count_ - mean * mean))};
    }
    const double c11 = m[0] * m[4] - m[2] * m[2];
    const double c12 = m[1] * m[2] - m[0] * m[3];
    const double c22 = m[0] * m[2] - m[1] * m[1];
    const double a = (o[0] * c00 + o[1] * c01 + o[2] * c02) / determinant;
    const double b = (o[0] * c01 + o[1] * c11 + o[2] * c12) / determinant;
    const double c = (o[0] * c02 + o[1] * c12 + o[2] * c22) / determinant;
    // Of a least squares fit: the rest is sum o^2 less what the parameters explain.
    const double rest = square_sum_ - (a * o[0] + b * o[1] + c * o[2]);
    return {a, std::sqrt(std::max(0.0, rest) / count_)};
  }

 private:
  std::array<double, 5> power_sum_{};
  std::array<double, 3> offset_sum_{};
  double square_sum_ = 0.0;
  int count_ = 0;
};

}  // namespace

void ContourMean::add(const model::Template& part, const refine::RawScan& raw,
                      const Pose& work_T_object, const refine::RawContourConfig& config) noexcept {
  for (int i = 0; i < part.contour_count; ++i) {
    const model::ContourPoint& p = part.contour[i];
    Parabola parabola;
    double width_sum_mm = 0.0;
    for (int k = -kReachInPitches; k <= kReachInPitches; ++k) {
      model::ContourPoint beside = p;
      const double along_mm = k * part.pitch_mm;
      beside.x_mm = static_cast<float>(p.x_mm - along_mm * p.ny);
      beside.y_mm = static_cast<float>(p.y_mm + along_mm * p.nx);
      const refine::Crossing crossing =
          refine::measure_crossing(raw, work_T_object, beside, config);
      if (!crossing.found) continue;
      parabola.add(k, crossing.offset_mm);
      width_sum_mm += crossing.width_mm;
    }
    // Near a corner or beside something else few lines agree: the edge's own place is the better
    // guess.
    constexpr int kLineCountMin = 3;
    if (parabola.count() < kLineCountMin) continue;
    const Parabola::Fit fit = parabola.fit();
    sum_mm_[i] += fit.at_zero;
    spread_sum_mm_[i] += fit.rms + 0.5 * width_sum_mm / parabola.count();
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
    p.spread_mm = static_cast<float>(spread_sum_mm_[i] / count_[i]);
    square_sum += shift_mm * shift_mm;
    ++measured_count;
  }
  *this = {};
  return measured_count > 0 ? std::sqrt(square_sum / measured_count) : 0.0;
}

}  // namespace flatpose::teach
