#include "flatpose/image/canny.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/crease.hpp"
#include "flatpose/image/glance.hpp"
#include "flatpose/image/hysteresis.hpp"
#include "flatpose/image/row_kernels.hpp"
#include "flatpose/image/slope_field.hpp"

namespace flatpose::image {
namespace {

struct EdgeScratch {
  ImageView<float> slope_x;
  ImageView<float> slope_y;
  std::span<std::int32_t> stack;
};

EdgeScratch lay_out(Arena& arena, int width_px, int height_px) noexcept {
  EdgeScratch s;
  s.slope_x = arena.take_image<float>(width_px, height_px);
  s.slope_y = arena.take_image<float>(width_px, height_px);
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

/// The slopes of row y and those `reach` rows away, held off the border.
ThreeRows rows_at(ImageView<const float> slope, int y, int reach) noexcept {
  const int last = slope.height_px - 2;
  return {slope.row(std::max(1, y - reach)), slope.row(y), slope.row(std::min(last, y + reach))};
}

// A crease of angle t changes the slope by at least t; seen along an axis, by 0.7 of it.
void mark_creases(const SlopeField& f, int y, float turn_low, std::uint8_t* marks) noexcept {
  const float* slope_x = f.slope_x.row(y);
  const ThreeRows slope_y = rows_at(f.slope_y, y, kCreaseReach_px);
  const float least = 0.5F * turn_low;
  const int last = f.slope_x.width_px - 2;
  for (int x = 1; x <= last; ++x) {
    const float left = slope_x[std::max(1, x - kCreaseReach_px)];
    const float right = slope_x[std::min(last, x + kCreaseReach_px)];
    if (std::max(std::fabs(right - left), std::fabs(slope_y.below[x] - slope_y.above[x])) >= least)
      marks[x] |= kMaybeCrease;
  }
}

std::uint8_t marked(EdgeKind kind, bool strong) noexcept {
  return static_cast<std::uint8_t>(static_cast<std::uint8_t>(kind) |
                                   (strong ? kStrongMark : kWeakMark));
}

/// Finds the edges of a height map and measures them, many at a time.
class EdgeFinder {
 public:
  EdgeFinder(const SlopeField& field, const Thresholds& thresholds, const RowKernels& kernels,
             ImageView<std::uint8_t> marks) noexcept
      : f_(field), jumps_(field), t_(thresholds), kernels_(kernels), marks_(marks) {}

  /// Marks what may be an edge. Slopes are written on the way: a row's tests look three rows on.
  void mark(ImageView<float> slope_x, ImageView<float> slope_y) noexcept {
    const int w = marks_.width_px;
    const int h = marks_.height_px;
    for (int ahead = 0; ahead < h + kBeside_px; ++ahead) {
      if (ahead < h)
        kernels_.sobel(three_rows(f_.height_mm, ahead), w, slope_x.row(ahead), slope_y.row(ahead));
      const int y = ahead - kBeside_px;
      if (y < 0) continue;
      if (y == 0 || y + 1 >= h || w < 3) {
        std::fill_n(marks_.row(y), w, std::uint8_t{0});
        continue;
      }
      kernels_.mark_jumps(f_.slope_x.row(y), rows_at(f_.slope_y, y, kBeside_px), w,
                          t_.jump_low_mm / kSmear_px, marks_.row(y));
      if (t_.creases) mark_creases(f_, y, t_.crease_low_tan * t_.cell_mm, marks_.row(y));
    }
  }

  /// Turns the marks of candidates into those of edges.
  void judge() noexcept {
    for_each_batch([this] { judge_batch(); });
  }

  /// Measures what was kept. Where the closer look finds no step left, noise beside a real contour
  /// was taken for one: that cell is dropped.
  Result<int> collect(std::span<EdgePoint> out) noexcept {
    std::size_t count = 0;
    for_each_batch([&] { collect_batch(out, count); });
    if (count > out.size()) return Status::kTooLarge;
    return static_cast<int>(count);
  }

 private:
  template <class Body>
  void for_each_batch(const Body& body) noexcept {
    batch_.count = 0;
    const auto flush = [&] {
      batch_.pad();
      body();
      batch_.count = 0;
    };
    for (int y = 1; y + 1 < marks_.height_px; ++y) {
      for_each_set(marks_.row(y), marks_.width_px, [&](int x) {
        batch_.add(x, y);
        if (batch_.count == JumpBatch::kCountMax) flush();
      });
    }
    flush();
  }

  void judge_batch() noexcept {
    kernels_.test_jumps(jumps_, t_.jump_low_mm, batch_);
    for (int i = 0; i < batch_.count; ++i) {
      std::uint8_t& mark = marks_(batch_.column[i], batch_.row[i]);
      mark = judged(i, mark);
    }
  }

  [[nodiscard]] std::uint8_t judged(int i, std::uint8_t candidate) const noexcept {
    const float step_mm = batch_.step_mm[i];
    if ((candidate & kMaybeJump) != 0 && step_mm >= t_.jump_low_mm) {
      return marked(batch_.below_is_missing[i] != 0 ? EdgeKind::kMissingBorder : EdgeKind::kJump,
                    step_mm >= t_.jump_high_mm);
    }
    const int x = batch_.column[i];
    const int y = batch_.row[i];
    if ((candidate & kMaybeCrease) == 0 || f_.missing(x, y) != 0) return 0;
    const float turn_tan = test_crease(f_, x, y, t_.cell_mm, t_.jump_low_mm).turn_tan;
    return turn_tan >= t_.crease_low_tan ? marked(EdgeKind::kCrease, turn_tan >= t_.crease_high_tan)
                                         : std::uint8_t{0};
  }

  void collect_batch(std::span<EdgePoint> out, std::size_t& count) noexcept {
    constexpr float kLeastLeft = 0.5F;  // of the threshold it has passed
    kernels_.measure_jumps(jumps_, t_.jump_low_mm, batch_);
    for (int i = 0; i < batch_.count; ++i) {
      std::uint8_t& mark = marks_(batch_.column[i], batch_.row[i]);
      const auto kind = static_cast<EdgeKind>(mark);
      if (kind != EdgeKind::kCrease && !(batch_.step_mm[i] >= kLeastLeft * t_.jump_low_mm)) {
        mark = 0;
        continue;
      }
      if (count < out.size()) out[count] = measured(i, kind);
      ++count;
    }
  }

  [[nodiscard]] EdgePoint measured(int i, EdgeKind kind) const noexcept {
    const JumpBatch& b = batch_;
    if (kind == EdgeKind::kCrease)
      return test_crease(f_, b.column[i], b.row[i], t_.cell_mm, t_.jump_low_mm).point;
    return {b.x_px[i],
            b.y_px[i],
            b.fall_x[i],
            b.fall_y[i],
            b.step_mm[i],
            static_cast<std::int16_t>(b.column[i]),
            static_cast<std::int16_t>(b.row[i]),
            kind};
  }

  const SlopeField& f_;
  JumpField jumps_;
  const Thresholds& t_;
  const RowKernels& kernels_;
  ImageView<std::uint8_t> marks_;
  JumpBatch batch_;
};

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
                         ImageView<std::uint8_t> kind_out, std::span<EdgePoint> out,
                         VectorPath path) noexcept {
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

  const SlopeField field(filled_mm, missing, s.slope_x, s.slope_y);
  const Thresholds thresholds{config.jump_low_mm,
                              config.jump_high_mm,
                              tangent(config.crease_low_rad),
                              tangent(config.crease_high_rad),
                              static_cast<float>(cell_mm),
                              config.crease_high_rad > 0.0F};
  EdgeFinder finder(field, thresholds, row_kernels(path), kind_out);
  finder.mark(s.slope_x, s.slope_y);
  finder.judge();
  keep_connected(kind_out, s.stack, path);
  return finder.collect(out);
}

}  // namespace flatpose::image
