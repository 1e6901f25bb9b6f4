#pragma once
// A place or a slope in the plane of an image.

#include <cmath>
#include <cstdint>
#include <cstring>

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
[[nodiscard]] inline Float2 load(const Vec2f* from) noexcept {
  Float2 both;
  std::memcpy(&both, from, sizeof both);
  return both;
}
[[nodiscard]] inline Vec2f unpacked(Float2 both) noexcept { return {both[0], both[1]}; }

[[nodiscard]] inline Float2 absolute(Float2 both) noexcept {
  return reinterpret_cast<Float2>(reinterpret_cast<Int2>(both) & 0x7fffffff);
}

}  // namespace flatpose::image
