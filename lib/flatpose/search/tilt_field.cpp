#include "flatpose/search/tilt_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

namespace flatpose::search {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Two neighbouring places side by side; the sums of each run in the order of its window.
using Pair = double __attribute__((vector_size(2 * sizeof(double))));
constexpr int kLanes = 2;

inline Pair load(const double* from) noexcept {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}
inline void store(const Pair& pair, double* to) noexcept { std::memcpy(to, &pair, sizeof pair); }

/// What the windows of a row's places sum up to, in equation (1) and (2).
struct Moments {
  Pair z{};
  Pair iz{};
  Pair jz{};
  Pair zz{};
};

/// Sums along rows wait in a ring until the windows that hold them are through.
class Fitter {
 public:
  Fitter(Arena& scratch, int width_px, int radius_px, int stride_px) noexcept
      : width_px_(width_px),
        r_(radius_px),
        stride_px_(stride_px),
        place_count_((width_px + stride_px - 1) / stride_px),
        row_doubles_(static_cast<std::size_t>(place_count_) + 2 * kTiltWindowRadiusMax_px + kLanes),
        heights_(scratch.take<double>(row_doubles_ * static_cast<std::size_t>(stride_px))),
        sums_(scratch.take<double>(row_doubles_ * 3 * static_cast<std::size_t>(window()))) {
    std::fill(heights_.begin(), heights_.end(), 0.0);
  }

  void run(ImageView<const float> filled_mm, double cell_mm, const TiltField& field) noexcept {
    base_mm_ = filled_mm(0, 0);
    const int height_px = filled_mm.height_px;
    for (int y = 0; y < height_px; ++y) {
      if (y % stride_px_ == 0 && (y < r_ || y >= height_px - r_)) write_none(y, field);
      spread_heights(filled_mm.row(y));
      sum_row(y);
      const int centre = y - r_;
      if (centre >= r_ && centre % stride_px_ == 0) fit_row(centre, cell_mm, field);
    }
  }

 private:
  [[nodiscard]] int window() const noexcept { return 2 * r_ + 1; }
  /// Heights of a row by phase, so that those at one offset from all places are neighbours.
  [[nodiscard]] double* phase(int offset_px) const noexcept {
    return heights_.data() + static_cast<std::size_t>(offset_px) * row_doubles_ +
           kTiltWindowRadiusMax_px;
  }
  /// Sums of z (0), i z (1) or z^2 (2) along row y.
  [[nodiscard]] double* sums(int y, int which) const noexcept {
    return sums_.data() + static_cast<std::size_t>(y % window() * 3 + which) * row_doubles_;
  }

  void spread_heights(const float* row_mm) noexcept {
    for (int offset_px = 0; offset_px < stride_px_; ++offset_px) {
      double* to = phase(offset_px);
      const int count = (width_px_ - offset_px + stride_px_ - 1) / stride_px_;
      const float* from = row_mm + offset_px;
      // Relative to the map's first height, so that squares keep their digits.
      for (int i = 0; i < count; ++i) to[i] = static_cast<double>(from[i * stride_px_] - base_mm_);
    }
  }

  void sum_row(int y) noexcept {
    for (int place = 0; place < place_count_; place += kLanes) {
      Pair z{};
      Pair iz{};
      Pair zz{};
      int whole = -((r_ + stride_px_ - 1) / stride_px_);  // i = whole * stride + offset
      int offset_px = -r_ - whole * stride_px_;
      for (int i = -r_; i <= r_; ++i) {
        const Pair h = load(phase(offset_px) + place + whole);
        z += h;
        iz += static_cast<double>(i) * h;
        zz += h * h;
        if (++offset_px == stride_px_) offset_px = 0, ++whole;
      }
      store(z, sums(y, 0) + place);
      store(iz, sums(y, 1) + place);
      store(zz, sums(y, 2) + place);
    }
  }

  [[nodiscard]] Moments sum_columns(int y, int place) const noexcept {
    Moments m;
    for (int j = -r_; j <= r_; ++j) {
      const Pair z = load(sums(y + j, 0) + place);
      m.z += z;
      m.iz += load(sums(y + j, 1) + place);
      m.jz += static_cast<double>(j) * z;
      m.zz += load(sums(y + j, 2) + place);
    }
    return m;
  }

  void fit_row(int y, double cell_mm, const TiltField& field) const noexcept {
    const double n = (2.0 * r_ + 1.0) * (2.0 * r_ + 1.0);
    const double spread = n * r_ * (r_ + 1.0) / 3.0;
    for (int place = 0; place < place_count_; place += kLanes) {
      const Moments m = sum_columns(y, place);
      const Pair a = m.iz / spread;  // mm per cell, (1)
      const Pair b = m.jz / spread;
      const Pair c = m.z / n;
      const Pair residual2 = m.zz - n * c * c - spread * (a * a + b * b);  // (2)
      const Pair slope_x = a / cell_mm;
      const Pair slope_y = b / cell_mm;
      const Pair plane_mm = static_cast<double>(base_mm_) + c;
      for (int k = 0; k < kLanes && place + k < place_count_; ++k) {
        const int x = (place + k) * stride_px_;
        const bool fits = x >= r_ && x < width_px_ - r_;
        field.slope_x(x, y) = fits ? static_cast<float>(slope_x[k]) : kNone;
        field.slope_y(x, y) = fits ? static_cast<float>(slope_y[k]) : kNone;
        field.plane_mm(x, y) = fits ? static_cast<float>(plane_mm[k]) : kNone;
        field.rms_mm(x, y) =
            fits ? static_cast<float>(std::sqrt(std::max(0.0, residual2[k]) / n)) : kNone;
      }
    }
  }

  void write_none(int y, const TiltField& field) const noexcept {
    for (const auto& image : {field.slope_x, field.slope_y, field.plane_mm, field.rms_mm}) {
      for (int x = 0; x < width_px_; x += stride_px_) image(x, y) = kNone;
    }
  }

  int width_px_;
  int r_;
  int stride_px_;
  int place_count_;
  std::size_t row_doubles_;
  std::span<double> heights_;
  std::span<double> sums_;
  float base_mm_ = 0.0F;
};

}  // namespace

TiltField take_tilt_field(Arena& arena, int width_px, int height_px) noexcept {
  return {
      arena.take_image<float>(width_px, height_px), arena.take_image<float>(width_px, height_px),
      arena.take_image<float>(width_px, height_px), arena.take_image<float>(width_px, height_px)};
}

void reserve_tilt_scratch(Arena& arena, int width_px) noexcept {
  (void)Fitter(arena, width_px, kTiltWindowRadiusMax_px, 1);  // strides make the rows shorter
}

Status fit_tilt_field(ImageView<const float> filled_mm, double cell_mm, int radius_px,
                      Arena& scratch, TiltField& field, int stride_px) noexcept {
  if (radius_px < 1 || radius_px > kTiltWindowRadiusMax_px || stride_px < 1 || !(cell_mm > 0.0))
    return Status::kInvalidArgument;
  for (const auto& image : {field.slope_x, field.slope_y, field.plane_mm, field.rms_mm}) {
    if (!same_shape(filled_mm, image)) return Status::kShapeMismatch;
  }
  if (filled_mm.empty()) return Status::kOk;
  const ArenaScope scope(scratch);
  Fitter fitter(scratch, filled_mm.width_px, radius_px, std::min(stride_px, filled_mm.width_px));
  if (scratch.failed()) return Status::kOutOfMemory;
  fitter.run(filled_mm, cell_mm, field);
  return Status::kOk;
}

}  // namespace flatpose::search
