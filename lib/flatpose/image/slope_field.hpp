#pragma once
// A height map and its slopes, read between the cells: what the edge detector looks at around a
// candidate.

#include <cmath>
#include <cstdint>

#include "flatpose/core/image_view.hpp"
#include "flatpose/image/vec2f.hpp"

namespace flatpose::image {

/// The one nearer to zero when both have one sign, else zero (also when one is NaN).
[[nodiscard]] inline float smaller_if_agreed(float a, float b) noexcept {
  if (!(a * b > 0.0F)) return 0.0F;
  return std::fabs(a) < std::fabs(b) ? a : b;
}

/// Views of one size. Slopes are Sobel's, in mm per cell.
class SlopeField {
 public:
  SlopeField(ImageView<const float> height_mm_, ImageView<const std::uint8_t> missing_,
             ImageView<const float> slope_x_, ImageView<const float> slope_y_) noexcept
      : height_mm(height_mm_),
        missing(missing_),
        slope_x(slope_x_),
        slope_y(slope_y_),
        last_{last(height_mm.width_px, 0), last(height_mm.height_px, 0)},
        last_inner_{last(height_mm.width_px, 1), last(height_mm.height_px, 1)} {}

  ImageView<const float> height_mm;
  ImageView<const std::uint8_t> missing;
  ImageView<const float> slope_x;
  ImageView<const float> slope_y;

  /// Bilinear slope; places outside the ring of border cells, where Sobel is wrong, are moved in.
  [[nodiscard]] Vec2f slope_at(Vec2f p) const noexcept {
    const Place at(p, Float2{1.0F, 1.0F}, last_inner_);
    return {blend(slope_x, at), blend(slope_y, at)};
  }
  [[nodiscard]] float height_at(Vec2f p) const noexcept {
    return blend(height_mm, Place(p, Float2{}, last_));
  }
  [[nodiscard]] bool missing_at(Vec2f p) const noexcept {
    const Place at(p, Float2{}, last_);
    return missing(at.column + (at.u >= 0.5F ? 1 : 0), at.row + (at.v >= 0.5F ? 1 : 0)) != 0;
  }

  /// The slope up `direction`, averaged (1 2 1) over a cell to both sides.
  [[nodiscard]] float climb_at(Vec2f p, Vec2f direction) const noexcept {
    const Vec2f aside = quarter_turn(direction);
    return 0.5F * dot(slope_at(p), direction) +
           0.25F * (dot(slope_at(p - aside), direction) + dot(slope_at(p + aside), direction));
  }
  /// The height, averaged likewise.
  [[nodiscard]] float mean_height_at(Vec2f p, Vec2f direction) const noexcept {
    const Vec2f aside = quarter_turn(direction);
    return 0.5F * height_at(p) + 0.25F * (height_at(p - aside) + height_at(p + aside));
  }

 private:
  /// A place's cell and where in it; between `low` and `high`, NaN at `low`.
  struct Place {
    int column;
    int row;
    float u;
    float v;

    Place(Vec2f p, Float2 low, Float2 high) noexcept {
      const Float2 free = {p.x, p.y};
      const Float2 above = free > low ? free : low;
      const Float2 at = above < high ? above : high;
      const Int2 cell = __builtin_convertvector(at, Int2);
      const Float2 rest = at - __builtin_convertvector(cell, Float2);
      column = cell[0], row = cell[1];
      u = rest[0], v = rest[1];
    }
  };
  static float blend(ImageView<const float> image, const Place& at) noexcept {
    const float* top = image.row(at.row) + at.column;
    const float* bottom = top + image.stride_px;
    const float a = top[0] + at.u * (top[1] - top[0]);
    const float b = bottom[0] + at.u * (bottom[1] - bottom[0]);
    return a + at.v * (b - a);
  }
  // Just below the last cell, so that its right neighbour exists.
  static float last(int size_px, int margin) noexcept {
    return static_cast<float>(size_px - 1 - margin) * (1.0F - 1e-6F);
  }

  Float2 last_;
  Float2 last_inner_;
};

}  // namespace flatpose::image
