#include "flatpose/search/tilt_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose::search {
namespace {

// Row sums of a window: of z, i z and z^2 (heights relative to the map's first, so that squares
// keep their digits).
struct RowSums {
  ImageView<double> z;
  ImageView<double> iz;
  ImageView<double> zz;
};

void sum_rows(ImageView<const float> filled_mm, float base_mm, int r,
              const RowSums& sums) noexcept {
  for (int y = 0; y < filled_mm.height_px; ++y) {
    const float* heights = filled_mm.row(y);
    double* z = sums.z.row(y);
    double* iz = sums.iz.row(y);
    double* zz = sums.zz.row(y);
    const int begin = r;
    const int end = filled_mm.width_px - r;
    for (int x = begin; x < end; ++x) z[x] = iz[x] = zz[x] = 0.0;
    for (int i = -r; i <= r; ++i) {
      for (int x = begin; x < end; ++x) {
        const double h = heights[x + i] - base_mm;
        z[x] += h;
        iz[x] += i * h;
        zz[x] += h * h;
      }
    }
  }
}

struct Moments {
  double z = 0.0;
  double iz = 0.0;
  double jz = 0.0;
  double zz = 0.0;
};

Moments sum_column(const RowSums& sums, int x, int y, int r) noexcept {
  Moments m;
  for (int j = -r; j <= r; ++j) {
    const double z = sums.z.row(y + j)[x];
    m.z += z;
    m.jz += j * z;
    m.iz += sums.iz.row(y + j)[x];
    m.zz += sums.zz.row(y + j)[x];
  }
  return m;
}

}  // namespace

TiltField take_tilt_field(Arena& arena, int width_px, int height_px) noexcept {
  return {
      arena.take_image<float>(width_px, height_px), arena.take_image<float>(width_px, height_px),
      arena.take_image<float>(width_px, height_px), arena.take_image<float>(width_px, height_px)};
}

Status fit_tilt_field(ImageView<const float> filled_mm, double cell_mm, int radius_px,
                      Arena& scratch, TiltField& field) noexcept {
  const int width_px = filled_mm.width_px;
  const int height_px = filled_mm.height_px;
  const int r = radius_px;
  if (r < 1 || r > kTiltWindowRadiusMax_px || !(cell_mm > 0.0)) return Status::kInvalidArgument;
  for (const auto& image : {field.slope_x, field.slope_y, field.plane_mm, field.rms_mm}) {
    if (!same_shape(filled_mm, image)) return Status::kShapeMismatch;
  }
  if (filled_mm.empty()) return Status::kOk;
  const ArenaScope scope(scratch);
  const RowSums sums{scratch.take_image<double>(width_px, height_px),
                     scratch.take_image<double>(width_px, height_px),
                     scratch.take_image<double>(width_px, height_px)};
  if (scratch.failed()) return Status::kOutOfMemory;

  const float base_mm = filled_mm(0, 0);
  sum_rows(filled_mm, base_mm, r, sums);
  const double n = (2.0 * r + 1.0) * (2.0 * r + 1.0);
  const double spread = n * r * (r + 1.0) / 3.0;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < height_px; ++y) {
    const bool inside_rows = y >= r && y < height_px - r;
    for (int x = 0; x < width_px; ++x) {
      if (!inside_rows || x < r || x >= width_px - r) {
        field.slope_x(x, y) = field.slope_y(x, y) = field.plane_mm(x, y) = field.rms_mm(x, y) =
            kNan;
        continue;
      }
      const Moments m = sum_column(sums, x, y, r);
      const double a = m.iz / spread;  // mm per cell, (1)
      const double b = m.jz / spread;
      const double c = m.z / n;
      const double residual2 = m.zz - n * c * c - spread * (a * a + b * b);  // (2)
      field.slope_x(x, y) = static_cast<float>(a / cell_mm);
      field.slope_y(x, y) = static_cast<float>(b / cell_mm);
      field.plane_mm(x, y) = static_cast<float>(base_mm + c);
      field.rms_mm(x, y) = static_cast<float>(std::sqrt(std::max(0.0, residual2) / n));
    }
  }
  return Status::kOk;
}

}  // namespace flatpose::search
