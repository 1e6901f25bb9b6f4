#pragma once
// A place or a slope in the plane of an image.

#include <cmath>
#include <cstdint>

namespace flatpose::image {

struct alignas(8) Vec2f {
  float x;
  float y;

  friend Vec2f operator+(Vec2f a, Vec2f b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend Vec2f operator-(Vec2f a, Vec2f b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend Vec2f operator*(float s, Vec2f a) noexcept { return {s * a.x, s * a.y}; }
};
[[nodiscard]] inline float dot(Vec2f a, Vec2f b) noexcept { return a.x * b.x + a.y * b.y; }
[[nodiscard]] inline float norm(Vec2f a) noexcept { return std::sqrt(dot(a, a)); }
[[nodiscard]] inline Vec2f quarter_turn(Vec2f a) noexcept { return {-a.y, a.x}; }

/// Both components of a Vec2f side by side in a register.
using Float2 = float __attribute__((vector_size(sizeof(Vec2f))));
using Int2 = std::int32_t __attribute__((vector_size(sizeof(Vec2f))));

}  // namespace flatpose::image
