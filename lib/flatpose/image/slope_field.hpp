#pragma once
// A height map and its slopes, read between the cells: what the edge detector looks at around a
// candidate.

#include <cmath>
#include <cstdint>

#include "flatpose/core/image_view.hpp"

namespace flatpose::image {

struct Vec2f {
  float x = 0.0F;
  float y = 0.0F;

  friend Vec2f operator+(Vec2f a, Vec2f b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend Vec2f operator-(Vec2f a, Vec2f b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend Vec2f operator*(float s, Vec2f a) noexcept { return {s * a.x, s * a.y}; }
};
[[nodiscard]] inline float dot(Vec2f a, Vec2f b) noexcept { return a.x * b.x + a.y * b.y; }
[[nodiscard]] inline float norm(Vec2f a) noexcept { return std::sqrt(dot(a, a)); }
[[nodiscard]] inline Vec2f quarter_turn(Vec2f a) noexcept { return {-a.y, a.x}; }

/// The one nearer to zero when both have one sign, else zero (also when one is NaN).
[[nodiscard]] inline float smaller_if_agreed(float a, float b) noexcept {
  if (!(a * b > 0.0F)) return 0.0F;
  return std::fabs(a) < std::fabs(b) ? a : b;
}

/// Views of one size. Slopes are Sobel's, in mm per cell.
struct SlopeField {
  ImageView<const float> height_mm;
  ImageView<const std::uint8_t> missing;
  ImageView<const float> slope_x;
  ImageView<const float> slope_y;

  /// Bilinear slope; places outside the ring of border cells, where Sobel is wrong, are moved in.
  [[nodiscard]] Vec2f slope_at(Vec2f p) const noexcept {
    const Place at = place(p, 1);
    return {mix(slope_x, at), mix(slope_y, at)};
  }
  [[nodiscard]] float height_at(Vec2f p) const noexcept { return mix(height_mm, place(p, 0)); }
  [[nodiscard]] bool missing_at(Vec2f p) const noexcept {
    const Place at = place(p, 0);
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
  struct Place {
    int column;
    int row;
    float u;
    float v;
  };
  static float clamp(float x, int margin, int size_px) noexcept {
    const auto low = static_cast<float>(margin);
    // Just below the last cell, so that its right neighbour exists; NaN goes to `low`.
    const float high = static_cast<float>(size_px - 1 - margin) * (1.0F - 1e-6F);
    const float above = x > low ? x : low;
    return above < high ? above : high;
  }
  [[nodiscard]] Place place(Vec2f p, int margin) const noexcept {
    const float x = clamp(p.x, margin, height_mm.width_px);
    const float y = clamp(p.y, margin, height_mm.height_px);
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    return {column, row, x - static_cast<float>(column), y - static_cast<float>(row)};
  }
  static float mix(ImageView<const float> image, const Place& at) noexcept {
    const float* top = image.row(at.row) + at.column;
    const float* bottom = top + image.stride_px;
    const float a = top[0] + at.u * (top[1] - top[0]);
    const float b = bottom[0] + at.u * (bottom[1] - bottom[0]);
    return a + at.v * (b - a);
  }
};

}  // namespace flatpose::image
