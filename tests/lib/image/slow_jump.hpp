#pragma once
// Jumps tested and measured one at a time: what the loops over many must come to, in every bit.

#include <algorithm>
#include <array>

#include "flatpose/image/jump_batch.hpp"
#include "flatpose/image/slope_field.hpp"

namespace flatpose::image::slow {

struct Jump {
  bool found = false;
  float step_mm = 0.0F;
  bool below_is_missing = false;
};

struct Measured {
  Vec2f at;
  Vec2f fall;
  float step_mm;
};

// A cell with a value at least this much larger than the next is larger; less is a tie, which the
// upper side wins. Without it rounding would pick both or none of the two cells beside a step.
constexpr float kTieFactor = 1.0F + 1e-4F;
constexpr float kFar_px = 5.0F;  // a slope beside the edge must last this far to be the surface's
constexpr float kNear_px = 2.5F;
constexpr float kHeight_px = 2.0F;  // distance at which the heights of both sides are read
constexpr float kFinite = 1e30F;

struct Ridge {
  Vec2f at;    // centre of the cell
  Vec2f fall;  // unit direction of the fall
  Vec2f surface_slope;
  bool found = false;
};

inline Vec2f agreed(Vec2f a, Vec2f b) noexcept {
  return {smaller_if_agreed(a.x, b.x), smaller_if_agreed(a.y, b.y)};
}

inline Vec2f cell_slope(const SlopeField& f, int column, int row) noexcept {
  const int x = std::clamp(column, 1, f.slope_x.width_px - 2);
  const int y = std::clamp(row, 1, f.slope_x.height_px - 2);
  return {f.slope_x(x, y), f.slope_y(x, y)};
}

// The direction of the jump at a cell, the surface's own slope taken off.
inline Ridge find_ridge(const SlopeField& f, int column, int row, float least) noexcept {
  Ridge ridge{{static_cast<float>(column), static_cast<float>(row)}, {}, {}, false};
  const Vec2f here = cell_slope(f, column, row);
  ridge.surface_slope = agreed(
      {cell_slope(f, column - kBeside_px, row).x, cell_slope(f, column, row - kBeside_px).y},
      {cell_slope(f, column + kBeside_px, row).x, cell_slope(f, column, row + kBeside_px).y});
  for (int round = 0; round < 2; ++round) {
    const Vec2f rest = here - ridge.surface_slope;
    const float length = norm(rest);
    if (!(length >= least && length < kFinite)) return ridge;
    ridge.fall = (-1.0F / length) * rest;
    if (round == 1) break;
    const Vec2f reach = static_cast<float>(kBeside_px) * ridge.fall;
    ridge.surface_slope = agreed(f.slope_at(ridge.at - reach), f.slope_at(ridge.at + reach));
  }
  ridge.found = true;
  return ridge;
}

// The surface's slope beside an edge found, read along five cells of the contour on each side.
inline Vec2f steady_surface_slope(const SlopeField& f, const Ridge& r) noexcept {
  const Vec2f along = 2.0F * quarter_turn(r.fall);
  const auto mean = [&](Vec2f p) {
    return 0.5F * f.slope_at(p) + 0.25F * (f.slope_at(p - along) + f.slope_at(p + along));
  };
  const Vec2f reach = static_cast<float>(kBeside_px) * r.fall;
  return agreed(mean(r.at - reach), mean(r.at + reach));
}

// How steeply it falls t cells along the ridge's direction.
inline float fall_at(const SlopeField& f, const Ridge& r, float t) noexcept {
  return -dot(f.slope_at(r.at + t * r.fall), r.fall);
}

// The surface's fall on one side: what lasts from near to far. Where nothing was seen it is level.
inline float side_fall(const SlopeField& f, Vec2f edge, Vec2f fall, float side) noexcept {
  if (f.missing_at(edge + (side * kNear_px) * fall)) return 0.0F;
  return smaller_if_agreed(-f.climb_at(edge + (side * kNear_px) * fall, fall),
                           -f.climb_at(edge + (side * kFar_px) * fall, fall));
}

struct Sides {
  float before = 0.0F;
  float after = 0.0F;
  float step_mm = 0.0F;
};

inline Sides look_beside(const SlopeField& f, Vec2f edge, Vec2f fall) noexcept {
  Sides s;
  s.before = side_fall(f, edge, fall, -1.0F);
  s.after = side_fall(f, edge, fall, 1.0F);
  s.step_mm = f.mean_height_at(edge - kHeight_px * fall, fall) -
              f.mean_height_at(edge + kHeight_px * fall, fall) - kHeight_px * (s.before + s.after);
  return s;
}

// Top of the parabola through values at -1, 0 and 1, the middle one being the largest.
inline float top_of_parabola(float before, float here, float after) noexcept {
  const float bend = before - 2.0F * here + after;
  if (!(bend < 0.0F)) return 0.0F;
  return std::clamp(0.5F * (before - after) / bend, -1.0F, 1.0F);
}

constexpr int kBell_px = 4;
constexpr std::array<float, 2 * kBell_px + 1> kBell = {1, 2, 3, 4, 5, 4, 3, 2, 1};

// Sum of the slopes around a place that point with the ridge, weighted by a bell: the direction of
// the contour along some cells of it. Columns first, then the columns' sums by halves.
inline Vec2f mean_fall(const SlopeField& f, const Ridge& r, int column, int row) noexcept {
  const float least = 0.25F * dot(r.surface_slope - f.slope_at(r.at), r.fall);
  std::array<Vec2f, 16> totals{};
  for (int dx = -kBell_px; dx <= kBell_px; ++dx) {
    for (int dy = -kBell_px; dy <= kBell_px; ++dy) {
      const Vec2f fall = r.surface_slope - cell_slope(f, column + dx, row + dy);
      if (!(dot(fall, r.fall) >= least)) continue;
      Vec2f& total = totals[dx + kBell_px];
      total = total + (kBell[dx + kBell_px] * kBell[dy + kBell_px]) * fall;
    }
  }
  for (std::size_t half = totals.size() / 2; half > 0; half /= 2) {
    for (std::size_t i = 0; i < half; ++i) totals[i] = totals[i] + totals[i + half];
  }
  const Vec2f total = totals[0];
  const float length = norm(total);
  return length > 0.0F && length < kFinite ? (1.0F / length) * total : r.fall;
}

inline Jump test_jump(const SlopeField& f, int column, int row, float jump_low_mm) noexcept {
  const Ridge r = find_ridge(f, column, row, jump_low_mm / kSmear_px);
  if (!r.found) return {};
  const float here = fall_at(f, r, 0.0F);
  const float before = fall_at(f, r, -1.0F);
  const float after = fall_at(f, r, 1.0F);
  if (!(here >= before * kTieFactor && here * kTieFactor >= after)) return {};
  if (!(here >= fall_at(f, r, -2.0F) && here >= fall_at(f, r, 2.0F))) return {};

  const Vec2f edge = r.at + top_of_parabola(before, here, after) * r.fall;
  // A filled slope below draws the edge toward it by up to a cell, so what lies above is looked for
  // further off than what lies below.
  constexpr float kAbove_px = 1.25F;
  constexpr float kBelow_px = 0.75F;
  if (f.missing_at(edge - kAbove_px * r.fall)) return {};
  const Sides sides = look_beside(f, edge, r.fall);
  const float excess = here - std::max(0.0F, std::max(sides.before, sides.after));
  const bool below_missing = f.missing_at(edge + kBelow_px * r.fall);
  return {true, std::min(sides.step_mm, kSmear_px * excess), below_missing};
}

inline Measured measure_jump(const SlopeField& f, int column, int row, float jump_low_mm) noexcept {
  Ridge r = find_ridge(f, column, row, jump_low_mm / kSmear_px);
  r.surface_slope = steady_surface_slope(f, r);
  r.fall = mean_fall(f, r, column, row);
  const auto fall = [&](float t) { return -f.climb_at(r.at + t * r.fall, r.fall); };
  const Vec2f edge = r.at + top_of_parabola(fall(-1.0F), fall(0.0F), fall(1.0F)) * r.fall;
  return {edge, r.fall, std::max(0.0F, look_beside(f, edge, r.fall).step_mm)};
}

}  // namespace flatpose::image::slow
