#include "flatpose/search/tilt_field.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "flatpose/search/tilt_rows.hpp"

namespace flatpose::search {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Sums along rows wait in a ring until the windows that hold them are through.
class Fitter {
 public:
  Fitter(Arena& scratch, int width_px, int radius_px, int stride_px,
         const TiltKernels& kernels) noexcept
      : width_px_(width_px),
        kernels_(kernels),
        window_{radius_px, stride_px, (width_px + stride_px - 1) / stride_px, 0} {
    window_.row_doubles = static_cast<std::size_t>(window_.place_count) +
                          2 * kTiltWindowRadiusMax_px + kPlacesAtOnceMax;
    heights_ = scratch.take<double>(window_.row_doubles * static_cast<std::size_t>(stride_px));
    sums_ = scratch.take<double>(window_.row_doubles * 3 * static_cast<std::size_t>(row_count()));
    fits_ = scratch.take<double>(window_.row_doubles * 4);
    std::fill(heights_.begin(), heights_.end(), 0.0);
  }

  void run(ImageView<const float> filled_mm, double cell_mm, const TiltField& field,
           const Budget& budget) noexcept {
    base_mm_ = filled_mm(0, 0);
    const int r = window_.radius_px;
    const int height_px = filled_mm.height_px;
    for (int y = 0; y < height_px && !budget.is_over_at(y); ++y) {
      if (y % window_.stride_px == 0 && (y < r || y >= height_px - r)) write_none(y, field);
      spread_heights(filled_mm.row(y));
      kernels_.sum_row(window_, heights_.data() + kTiltWindowRadiusMax_px, sums(y));
      const int centre = y - r;
      if (centre >= r && centre % window_.stride_px == 0) fit_row(centre, cell_mm, field);
    }
  }

 private:
  [[nodiscard]] int row_count() const noexcept { return 2 * window_.radius_px + 1; }
  [[nodiscard]] TiltRowSums sums(int y) const noexcept {
    double* const first =
        sums_.data() + static_cast<std::size_t>(y % row_count() * 3) * window_.row_doubles;
    return {first, first + window_.row_doubles, first + 2 * window_.row_doubles};
  }

  // Heights of a row by phase, so that those at one offset from all places are neighbours.
  void spread_heights(const float* row_mm) noexcept {
    const int stride_px = window_.stride_px;
    for (int offset_px = 0; offset_px < stride_px; ++offset_px) {
      double* to = heights_.data() + static_cast<std::size_t>(offset_px) * window_.row_doubles +
                   kTiltWindowRadiusMax_px;
      const int count = (width_px_ - offset_px + stride_px - 1) / stride_px;
      const float* from = row_mm + offset_px;
      // Relative to the map's first height, so that squares keep their digits.
      for (int i = 0; i < count; ++i) to[i] = static_cast<double>(from[i * stride_px] - base_mm_);
    }
  }

  void fit_row(int y, double cell_mm, const TiltField& field) noexcept {
    const int r = window_.radius_px;
    std::array<TiltRowSums, 2 * kTiltWindowRadiusMax_px + 1> rows;
    for (int j = -r; j <= r; ++j) rows[static_cast<std::size_t>(j + r)] = sums(y + j);
    const std::size_t n = window_.row_doubles;
    const TiltRowFits fits{fits_.data(), fits_.data() + n, fits_.data() + 2 * n,
                           fits_.data() + 3 * n};
    kernels_.fit_row(window_, rows.data(), fits);
    for (int place = 0; place < window_.place_count; ++place) {
      const int x = place * window_.stride_px;
      const bool is_full = x >= r && x < width_px_ - r;
      field.slope_x(x, y) = is_full ? static_cast<float>(fits.a[place] / cell_mm) : kNone;
      field.slope_y(x, y) = is_full ? static_cast<float>(fits.b[place] / cell_mm) : kNone;
      field.plane_mm(x, y) =
          is_full ? static_cast<float>(static_cast<double>(base_mm_) + fits.c_mm[place]) : kNone;
      field.rms_mm(x, y) = is_full ? static_cast<float>(fits.rms_mm[place]) : kNone;
    }
  }

  void write_none(int y, const TiltField& field) const noexcept {
    for (const auto& image : {field.slope_x, field.slope_y, field.plane_mm, field.rms_mm}) {
      for (int x = 0; x < width_px_; x += window_.stride_px) image(x, y) = kNone;
    }
  }

  int width_px_;
  const TiltKernels& kernels_;
  TiltWindow window_;
  std::span<double> heights_;
  std::span<double> sums_;
  std::span<double> fits_;
  float base_mm_ = 0.0F;
};

}  // namespace

const TiltKernels& tilt_kernels(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, kPortableTiltKernels, kAvx2TiltKernels, kAvx512TiltKernels);
}

TiltField take_tilt_field(Arena& arena, int width_px, int height_px) noexcept {
  return {
      arena.take_image<float>(width_px, height_px), arena.take_image<float>(width_px, height_px),
      arena.take_image<float>(width_px, height_px), arena.take_image<float>(width_px, height_px)};
}

void reserve_tilt_scratch(Arena& arena, int width_px) noexcept {
  (void)Fitter(arena, width_px, kTiltWindowRadiusMax_px, 1,
               kPortableTiltKernels);  // strides make the rows shorter
}

Status fit_tilt_field(ImageView<const float> filled_mm, double cell_mm, int radius_px,
                      Arena& scratch, TiltField& field, int stride_px, VectorPath path,
                      const Budget& budget) noexcept {
  if (radius_px < 1 || radius_px > kTiltWindowRadiusMax_px || stride_px < 1 || !(cell_mm > 0.0))
    return Status::kInvalidArgument;
  for (const auto& image : {field.slope_x, field.slope_y, field.plane_mm, field.rms_mm}) {
    if (!same_shape(filled_mm, image)) return Status::kShapeMismatch;
  }
  if (filled_mm.empty()) return Status::kOk;
  const ArenaScope scope(scratch);
  Fitter fitter(scratch, filled_mm.width_px, radius_px, std::min(stride_px, filled_mm.width_px),
                tilt_kernels(path));
  if (scratch.failed()) return Status::kOutOfMemory;
  fitter.run(filled_mm, cell_mm, field, budget);
  return budget.was_over() ? Status::kStopped : Status::kOk;
}

}  // namespace flatpose::search
