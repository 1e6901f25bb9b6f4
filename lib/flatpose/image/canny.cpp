#include "flatpose/image/canny.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/crease.hpp"
#include "flatpose/image/glance.hpp"
#include "flatpose/image/hysteresis.hpp"
#include "flatpose/image/jump.hpp"
#include "flatpose/image/slope_field.hpp"
#include "flatpose/image/sobel.hpp"

namespace flatpose::image {
namespace {

constexpr std::uint8_t kMaybeJump = 1;
constexpr std::uint8_t kMaybeCrease = 2;

struct EdgeScratch {
  ImageView<Vec2f> slope;
  std::span<std::int32_t> stack;
};

EdgeScratch lay_out(Arena& arena, int width_px, int height_px) noexcept {
  EdgeScratch s;
  s.slope = arena.take_image<Vec2f>(width_px, height_px);
  s.stack = arena.take<std::int32_t>(static_cast<std::size_t>(width_px) *
                                     static_cast<std::size_t>(height_px));
  return s;
}

struct Thresholds {
  float jump_low_mm;
  float jump_high_mm;
  float crease_low_tan;
  float crease_high_tan;
  float cell_mm;
  bool creases;
};

float tangent(float angle_rad) noexcept {
  const SinCos s = sin_cos(static_cast<double>(angle_rad));
  return s.cos > 1e-9 ? static_cast<float>(s.sin / s.cos) : 1e9F;
}

// A row of slopes with those three (jumps) or two (creases) cells away.
struct SlopeRows {
  const Vec2f* here;
  const Vec2f* above;
  const Vec2f* below;
};

SlopeRows rows_at(const SlopeField& f, int y, int reach) noexcept {
  const int last = f.slope.height_px - 2;
  return {f.slope.row(y), f.slope.row(std::max(1, y - reach)),
          f.slope.row(std::min(last, y + reach))};
}

// Marks the cells of a row at which `test(x, left, right)` holds; left and right are `reach` cells
// away, held off the border.
template <class Test>
void mark_row(int width_px, int reach, std::uint8_t mark, std::uint8_t* __restrict marks,
              const Test& test) noexcept {
  const int last = width_px - 2;
  const int inner = std::min(1 + reach, last + 1);
  const int inner_end = std::max(inner, last + 1 - reach);
  const auto put = [&](int x, int left, int right) {
    marks[x] = static_cast<std::uint8_t>(marks[x] | (test(x, left, right) ? mark : 0));
  };
  for (int x = 1; x < inner; ++x) put(x, std::max(1, x - reach), std::min(last, x + reach));
  for (int x = inner; x < inner_end; ++x) put(x, x - reach, x + reach);
  for (int x = inner_end; x <= last; ++x) put(x, std::max(1, x - reach), std::min(last, x + reach));
}

// The slope that stands out from the surface's, axis by axis.
void mark_jumps(const SlopeField& f, int y, float jump_low_mm, std::uint8_t* marks) noexcept {
  const SlopeRows r = rows_at(f, y, kBeside_px);
  const float least = jump_low_mm / kSmear_px;
  const float least_squared = least * least;
  // Branch-free form of smaller_if_agreed.
  const auto agreed = [](float a, float b) {
    return std::max(0.0F, std::min(a, b)) + std::min(0.0F, std::max(a, b));
  };
  mark_row(f.slope.width_px, kBeside_px, kMaybeJump, marks, [=](int x, int left, int right) {
    const float rest_x = r.here[x].x - agreed(r.here[left].x, r.here[right].x);
    const float rest_y = r.here[x].y - agreed(r.above[x].y, r.below[x].y);
    return rest_x * rest_x + rest_y * rest_y >= least_squared;
  });
}

// A crease of angle t changes the slope by at least t; seen along an axis, by 0.7 of it.
void mark_creases(const SlopeField& f, int y, float turn_low, std::uint8_t* marks) noexcept {
  const SlopeRows r = rows_at(f, y, kCreaseReach_px);
  const float least = 0.5F * turn_low;
  mark_row(f.slope.width_px, kCreaseReach_px, kMaybeCrease, marks, [=](int x, int left, int right) {
    return std::max(std::fabs(r.here[right].x - r.here[left].x),
                    std::fabs(r.below[x].y - r.above[x].y)) >= least;
  });
}

std::uint8_t marked(EdgeKind kind, bool strong) noexcept {
  return static_cast<std::uint8_t>(static_cast<std::uint8_t>(kind) |
                                   (strong ? kStrongMark : kWeakMark));
}

// What a candidate turns out to be.
std::uint8_t judge(const SlopeField& f, const Thresholds& t, int x, int y,
                   std::uint8_t candidate) noexcept {
  if ((candidate & kMaybeJump) != 0) {
    const JumpTest jump = test_jump(f, x, y, t.jump_low_mm);
    if (jump.strength_mm >= t.jump_low_mm) {
      return marked(jump.kind, jump.strength_mm >= t.jump_high_mm);
    }
  }
  if ((candidate & kMaybeCrease) != 0 && f.missing(x, y) == 0) {
    const float turn_tan = test_crease(f, x, y, t.cell_mm, t.jump_low_mm).turn_tan;
    if (turn_tan >= t.crease_low_tan)
      return marked(EdgeKind::kCrease, turn_tan >= t.crease_high_tan);
  }
  return 0;
}

void mark_edges(const SlopeField& f, const Thresholds& t, ImageView<std::uint8_t> marks) noexcept {
  for (int y = 0; y < marks.height_px; ++y) {
    std::uint8_t* row = marks.row(y);
    std::fill_n(row, marks.width_px, std::uint8_t{0});
    if (y == 0 || y + 1 >= marks.height_px || marks.width_px < 3) continue;
    mark_jumps(f, y, t.jump_low_mm, row);
    if (t.creases) mark_creases(f, y, t.crease_low_tan * t.cell_mm, row);
    for_each_set(row, marks.width_px, [&](int x) { row[x] = judge(f, t, x, y, row[x]); });
  }
}

EdgePoint measure(const SlopeField& f, const Thresholds& t, int x, int y, EdgeKind kind) noexcept {
  if (kind == EdgeKind::kCrease) return test_crease(f, x, y, t.cell_mm, t.jump_low_mm).point;
  EdgePoint point = measure_jump(f, x, y, t.jump_low_mm);
  point.kind = kind;
  return point;
}

// Measures what was kept. Where the closer look finds no step left, noise beside a real contour was
// taken for one: that cell is dropped.
Result<int> collect(const SlopeField& f, const Thresholds& t, ImageView<std::uint8_t> kinds,
                    std::span<EdgePoint> out) noexcept {
  constexpr float kLeastLeft = 0.5F;  // of the threshold it has passed
  std::size_t count = 0;
  for (int y = 0; y < kinds.height_px; ++y) {
    std::uint8_t* row = kinds.row(y);
    for_each_set(row, kinds.width_px, [&](int x) {
      const EdgePoint point = measure(f, t, x, y, static_cast<EdgeKind>(row[x]));
      if (point.kind != EdgeKind::kCrease && !(point.step_mm >= kLeastLeft * t.jump_low_mm)) {
        row[x] = 0;
        return;
      }
      if (count < out.size()) out[count] = point;
      ++count;
    });
  }
  if (count > out.size()) return Status::kTooLarge;
  return static_cast<int>(count);
}

}  // namespace

Status validate(const EdgeConfig& c) noexcept {
  const bool jumps =
      c.jump_low_mm > 0.0F && c.jump_high_mm >= c.jump_low_mm && c.jump_high_mm < 1e6F;
  const bool no_creases = c.crease_low_rad == 0.0F && c.crease_high_rad == 0.0F;
  const bool creases = c.crease_low_rad > 0.0F && c.crease_high_rad >= c.crease_low_rad &&
                       static_cast<double>(c.crease_high_rad) <= kPi / 2.0;
  return jumps && (no_creases || creases) ? Status::kOk : Status::kInvalidArgument;
}

void reserve_edge_scratch(Arena& arena, int width_px, int height_px) noexcept {
  (void)lay_out(arena, width_px, height_px);
}

Result<int> detect_edges(ImageView<const float> filled_mm, ImageView<const std::uint8_t> missing,
                         double cell_mm, const EdgeConfig& config, Arena& scratch,
                         ImageView<std::uint8_t> kind_out, std::span<EdgePoint> out) noexcept {
  const Status valid = validate(config);
  if (valid != Status::kOk) return valid;
  if (!(cell_mm > 0.0) || !(cell_mm < 1e6)) return Status::kInvalidArgument;
  if (!same_shape(filled_mm, missing) || !same_shape(filled_mm, kind_out)) {
    return Status::kShapeMismatch;
  }
  if (filled_mm.empty()) return 0;
  if (std::max(filled_mm.width_px, filled_mm.height_px) > kEdgeMapSizeMax_px) {
    return Status::kTooLarge;
  }
  const ArenaScope scope(scratch);
  const EdgeScratch s = lay_out(scratch, filled_mm.width_px, filled_mm.height_px);
  if (s.stack.empty()) return Status::kOutOfMemory;

  const Status status = sobel(filled_mm, s.slope);
  if (status != Status::kOk) return status;
  const SlopeField field{filled_mm, missing, s.slope};
  const Thresholds thresholds{config.jump_low_mm,
                              config.jump_high_mm,
                              tangent(config.crease_low_rad),
                              tangent(config.crease_high_rad),
                              static_cast<float>(cell_mm),
                              config.crease_high_rad > 0.0F};
  mark_edges(field, thresholds, kind_out);
  keep_connected(kind_out, s.stack);
  return collect(field, thresholds, kind_out, out);
}

}  // namespace flatpose::image
