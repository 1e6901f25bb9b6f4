#include "flatpose/image/pyramid.hpp"

#include <limits>

namespace flatpose::image {
namespace {

inline float mean_of_upper(float a, float b, float c, float d, float jump_mm) noexcept {
  constexpr float kNone = -std::numeric_limits<float>::infinity();
  const auto higher = [](float z, float best) { return z > best ? z : best; };  // skips NaN
  const float top = higher(a, higher(b, higher(c, higher(d, kNone))));
  const float floor_mm = top - jump_mm;
  float sum = 0.0F;
  float count = 0.0F;
  const auto add = [&](float z) {
    const bool counts = z >= floor_mm;
    sum += counts ? z - top : 0.0F;  // about the top, to keep the low bits
    count += counts ? 1.0F : 0.0F;
  };
  add(a);
  add(b);
  add(c);
  add(d);
  return count > 0.0F ? top + sum / count : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

rectify::Grid halved(const rectify::Grid& grid) noexcept {
  return {grid.x_of(0.5), grid.y_of(0.5), 2.0 * grid.cell_mm, halved(grid.width_px),
          halved(grid.height_px)};
}

Status halve(ImageView<const float> fine_mm, float jump_mm, ImageView<float> coarse_mm) noexcept {
  if (!(jump_mm >= 0.0F)) return Status::kInvalidArgument;
  if (coarse_mm.width_px != halved(fine_mm.width_px) ||
      coarse_mm.height_px != halved(fine_mm.height_px)) {
    return Status::kShapeMismatch;
  }
  constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
  const int pairs = fine_mm.width_px / 2;
  for (int y = 0; y < coarse_mm.height_px; ++y) {
    const float* top = fine_mm.row(2 * y);
    // An odd last row is its own partner: counting each of its cells twice leaves their mean.
    const float* bottom = 2 * y + 1 < fine_mm.height_px ? fine_mm.row(2 * y + 1) : top;
    float* out = coarse_mm.row(y);
    for (int x = 0; x < pairs; ++x) {
      out[x] = mean_of_upper(top[2 * x], top[2 * x + 1], bottom[2 * x], bottom[2 * x + 1], jump_mm);
    }
    if (pairs < coarse_mm.width_px) {
      out[pairs] = mean_of_upper(top[2 * pairs], bottom[2 * pairs], kMissing, kMissing, jump_mm);
    }
  }
  return Status::kOk;
}

}  // namespace flatpose::image
