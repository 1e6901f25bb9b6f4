#include "flatpose/image/crease.hpp"

#include <algorithm>

namespace flatpose::image {
namespace {

constexpr float kFinite = 1e30F;
constexpr float kNear_px = 2.0F;
constexpr float kFar_px = 5.0F;
constexpr float kTieFactor = 1.0F + 1e-4F;

// The direction across the crease: the eigenvector of the matrix of second differences whose
// eigenvalue is the largest in size.
Vec2f across(const SlopeField& f, int column, int row) noexcept {
  const Vec2f p{static_cast<float>(column), static_cast<float>(row)};
  constexpr float kReach = kCreaseReach_px;
  const Vec2f along_x = f.slope_at(p + Vec2f{kReach, 0}) - f.slope_at(p - Vec2f{kReach, 0});
  const Vec2f along_y = f.slope_at(p + Vec2f{0, kReach}) - f.slope_at(p - Vec2f{0, kReach});
  const float mixed = 0.5F * (along_x.y + along_y.x);
  const float sum = along_x.x + along_y.y;
  const float half_difference = 0.5F * (along_x.x - along_y.y);
  const float root = std::sqrt(half_difference * half_difference + mixed * mixed);
  // Both forms are the eigenvector of the larger eigenvalue; one of them may be short.
  Vec2f v = half_difference >= 0.0F ? Vec2f{half_difference + root, mixed}
                                    : Vec2f{mixed, root - half_difference};
  if (sum < 0.0F) v = quarter_turn(v);
  const float length = norm(v);
  if (!(length > 0.0F && length < kFinite)) return {};
  return (1.0F / length) * v;
}

struct Range {
  float low;
  float high;
};

// Samples held back at the border would be taken for slopes further out.
bool window_fits(const SlopeField& f, int column, int row) noexcept {
  constexpr int kReach_px = static_cast<int>(kFar_px);
  return column > kReach_px && row > kReach_px && column + kReach_px + 1 < f.height_mm.width_px &&
         row + kReach_px + 1 < f.height_mm.height_px;
}

// Slopes up `n` on one side, at two distances: a jump nearby can spoil but one of them.
Range side_climb(const SlopeField& f, Vec2f p, Vec2f n, float side) noexcept {
  const float a = f.climb_at(p + (side * kNear_px) * n, n);
  const float b = f.climb_at(p + (side * kFar_px) * n, n);
  return {std::min(a, b), std::max(a, b)};
}

constexpr float kSide_px = 3.0F;

// Whether the heights beside the crease are those of its two slopes: near a jump they are not.
bool follows_two_planes(const SlopeField& f, Vec2f p, Vec2f n, float slope_a, float slope_b,
                        float margin_mm) noexcept {
  const float z = f.mean_height_at(p, n);
  const float rise_b = f.mean_height_at(p + kSide_px * n, n) - z;
  const float rise_a = z - f.mean_height_at(p - kSide_px * n, n);
  return std::fabs(rise_a - kSide_px * slope_a) <= margin_mm &&
         std::fabs(rise_b - kSide_px * slope_b) <= margin_mm;
}

float tan_between(float a, float b) noexcept {
  const float cosine_part = 1.0F + a * b;
  return cosine_part > 0.0F ? std::fabs(b - a) / cosine_part : kFinite;
}

}  // namespace

CreaseTest test_crease(const SlopeField& f, int column, int row, float cell_mm,
                       float jump_low_mm) noexcept {
  if (!window_fits(f, column, row)) return {};
  const Vec2f p{static_cast<float>(column), static_cast<float>(row)};
  const Vec2f n = across(f, column, row);
  if (!(norm(n) > 0.0F)) return {};
  const auto climb = [&](float t) { return f.climb_at(p + t * n, n); };
  const float m[5] = {climb(-2.0F), climb(-1.0F), climb(0.0F), climb(1.0F), climb(2.0F)};
  const float before = std::fabs(m[2] - m[0]);
  const float here = std::fabs(m[3] - m[1]);
  const float after = std::fabs(m[4] - m[2]);
  if (!(here >= before * kTieFactor && here * kTieFactor >= after)) return {};

  const Range a = side_climb(f, p, n, -1.0F);
  const Range b = side_climb(f, p, n, 1.0F);
  const bool rises = b.low > a.high;
  if (!rises && !(b.high < a.low)) return {};
  const float slope_a = rises ? a.high : a.low;
  const float slope_b = rises ? b.low : b.high;
  if (!follows_two_planes(f, p, n, slope_a, slope_b, 0.5F * jump_low_mm)) return {};
  const bool falls = f.height_at(p + kSide_px * n) <= f.height_at(p - kSide_px * n);
  const Vec2f fall = falls ? n : -1.0F * n;
  const float bend = before - 2.0F * here + after;
  const float offset = bend < 0.0F ? std::clamp(0.5F * (before - after) / bend, -1.0F, 1.0F) : 0.0F;
  const Vec2f edge = p + offset * n;
  return {tan_between(slope_a / cell_mm, slope_b / cell_mm),
          {edge.x, edge.y, fall.x, fall.y, 0.0F, static_cast<std::int16_t>(column),
           static_cast<std::int16_t>(row), EdgeKind::kCrease}};
}

}  // namespace flatpose::image
