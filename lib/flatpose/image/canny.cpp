#include "flatpose/image/canny.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/crease.hpp"
#include "flatpose/image/glance.hpp"
#include "flatpose/image/hysteresis.hpp"
#include "flatpose/image/row_kernels.hpp"
#include "flatpose/image/slope_band.hpp"
#include "flatpose/image/slope_field.hpp"
#include "flatpose/rectify/slots.hpp"

namespace flatpose::image {
namespace {

using rectify::kChunkCountMax;
using rectify::RowChunks;
using rectify::Slots;

// Rows whose slopes are looked at together: few enough to stay near the processor, enough to make
// light of the rows worked out twice.
constexpr int kBandRows = 64;
// Tops of ridges are thinner than this.
constexpr std::size_t kCellsPerTop = 2;

/// What one chunk of rows works in.
struct ChunkScratch {
  SlopeBand slopes;
  std::span<std::uint8_t> marks;  // of a row

  ChunkScratch() = default;
  ChunkScratch(Arena& arena, int width_px, int height_px) noexcept
      : slopes(SlopeBand::take(arena, width_px,
                               std::min(kBandRows, height_px) + 2 * SlopeBand::kHalo_px)),
        marks(arena.take<std::uint8_t>(static_cast<std::size_t>(width_px))) {}
};

struct EdgeScratch {
  std::array<ChunkScratch, kChunkCountMax> chunks;
  std::span<EdgePoint> tops;
  std::span<std::int32_t> stack;  // every kept cell is in the lists of tops
};

EdgeScratch lay_out(Arena& arena, int width_px, int height_px) noexcept {
  EdgeScratch s;
  const RowChunks chunks(height_px, kBandRows);
  for (int i = 0; i < chunks.count(); ++i)
    s.chunks[static_cast<std::size_t>(i)] = ChunkScratch(arena, width_px, height_px);
  const std::size_t top_count =
      static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) / kCellsPerTop;
  s.tops = arena.take<EdgePoint>(top_count);
  s.stack = arena.take<std::int32_t>(top_count);
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

// A crease of angle t changes the slope by at least t; seen along an axis, by 0.7 of it.
void mark_creases(const SlopeBand& slopes, int y, int width_px, float turn_low,
                  std::uint8_t* marks) noexcept {
  const float* slope_x = slopes.x_row(y);
  const float* above = slopes.y_row(y - kCreaseReach_px);
  const float* below = slopes.y_row(y + kCreaseReach_px);
  const float least = 0.5F * turn_low;
  for (int x = 1; x + 1 < width_px; ++x) {
    const float along_x = slope_x[x + kCreaseReach_px] - slope_x[x - kCreaseReach_px];
    if (std::max(std::fabs(along_x), std::fabs(below[x] - above[x])) >= least)
      marks[x] |= kMaybeCrease;
  }
}

std::uint8_t marked(EdgeKind kind, bool strong) noexcept {
  return static_cast<std::uint8_t>(static_cast<std::uint8_t>(kind) |
                                   (strong ? kStrongMark : kWeakMark));
}

struct Views {
  ImageView<const float> filled_mm;
  ImageView<const std::uint8_t> missing;
  ImageView<std::uint8_t> marks;
};

/// Finds the tops of ridges of some rows and measures them, many at a time.
class TopFinder {
 public:
  TopFinder(const Views& views, const Thresholds& thresholds, VectorPath path,
            ChunkScratch& scratch, std::span<EdgePoint> tops, const Budget& budget) noexcept
      : v_(views),
        t_(thresholds),
        path_(path),
        kernels_(row_kernels(path)),
        scratch_(scratch),
        tops_(tops),
        budget_(budget) {}

  /// Appends them to `tops` and marks their cells. Returns how many there are, also when there is
  /// no room for all.
  std::size_t run(int row_begin, int row_end) noexcept {
    for (int begin = row_begin; begin < row_end && !budget_.is_over(); begin += kBandRows)
      run_band(begin, std::min(begin + kBandRows, row_end));
    return count_;
  }

 private:
  void run_band(int begin, int end) noexcept {
    const int w = v_.marks.width_px;
    for (int y = begin; y < end; ++y) std::fill_n(v_.marks.row(y), w, std::uint8_t{0});
    begin = std::max(begin, 1);
    end = std::min(end, v_.marks.height_px - 1);
    if (w < 3 || begin >= end) return;
    scratch_.slopes.fill(v_.filled_mm, begin - SlopeBand::kHalo_px, end + SlopeBand::kHalo_px,
                         path_);
    const JumpField field(v_.filled_mm, v_.missing, scratch_.slopes);
    batch_.count = 0;
    for (int y = begin; y < end && !budget_.is_over_at(y); ++y) {
      mark(y);
      for_each_set(scratch_.marks.data(), w, [&](int x) {
        if (batch_.count == JumpBatch::kCountMax) flush(field);
        may_be_[batch_.count] = scratch_.marks[static_cast<std::size_t>(x)];
        batch_.add(x, y);
      });
    }
    if (batch_.count > 0) flush(field);
  }

  /// Marks what may be an edge.
  void mark(int y) noexcept {
    const SlopeBand& s = scratch_.slopes;
    const int w = v_.marks.width_px;
    kernels_.mark_jumps(s.x_row(y), {s.y_row(y - kBeside_px), s.y_row(y), s.y_row(y + kBeside_px)},
                        w, t_.jump_low_mm / kSmear_px, scratch_.marks.data());
    if (t_.creases) mark_creases(s, y, w, t_.crease_low_tan * t_.cell_mm, scratch_.marks.data());
  }

  void flush(const JumpField& field) noexcept {
    batch_.pad();
    kernels_.test_jumps(field, t_.jump_low_mm, batch_);
    kernels_.measure_jumps(field, batch_);
    int next_cell = 0;
    for (int i = 0; i < batch_.jump_count; ++i) {
      const int cell = batch_.index[i];
      if (t_.creases) {
        for (; next_cell < cell; ++next_cell) add_crease(next_cell);
        if ((may_be_[cell] & kMaybeJump) == 0) continue;
        next_cell = cell + 1;
      }
      add_jump(i);
    }
    for (; t_.creases && next_cell < batch_.count; ++next_cell) add_crease(next_cell);
    batch_.count = 0;
  }

  void add_jump(int i) noexcept {
    const JumpBatch& b = batch_;
    const EdgeKind kind = b.below_is_missing[i] != 0 ? EdgeKind::kMissingBorder : EdgeKind::kJump;
    const int cell = b.index[i];
    add({b.x_px[i], b.y_px[i], b.fall_x[i], b.fall_y[i], b.step_mm[i],
         static_cast<std::int16_t>(b.column[cell]), static_cast<std::int16_t>(b.row[cell]), kind},
        b.tested_step_mm[i] >= t_.jump_high_mm);
  }

  void add_crease(int cell) noexcept {
    const int x = batch_.column[cell];
    const int y = batch_.row[cell];
    if ((may_be_[cell] & kMaybeCrease) == 0 || v_.missing(x, y) != 0) return;
    const SlopeBand& s = scratch_.slopes;
    const auto slopes = [&](float* first) {
      return ImageView<const float>{first + s.origin(), v_.marks.width_px, v_.marks.height_px,
                                    s.stride_px};
    };
    const SlopeField field(v_.filled_mm, v_.missing, slopes(s.x), slopes(s.y));
    const CreaseTest crease = test_crease(field, x, y, t_.cell_mm, t_.jump_low_mm);
    if (crease.turn_tan >= t_.crease_low_tan)
      add(crease.point, crease.turn_tan >= t_.crease_high_tan);
  }

  void add(const EdgePoint& point, bool strong) noexcept {
    if (count_ < tops_.size()) {
      tops_[count_] = point;
      v_.marks.row(point.row)[point.column] = marked(point.kind, strong);
    }
    ++count_;
  }

  const Views& v_;
  const Thresholds& t_;
  VectorPath path_;
  const RowKernels& kernels_;
  ChunkScratch& scratch_;
  std::span<EdgePoint> tops_;
  const Budget& budget_;
  std::size_t count_ = 0;
  JumpBatch batch_;
  std::array<std::uint8_t, JumpBatch::kCountMax> may_be_;
};

/// The tops of all rows, chunk by chunk.
class TopLists {
 public:
  TopLists(const Views& views, const EdgeScratch& scratch) noexcept
      : chunks_(views.marks.height_px, kBandRows), views_(views), scratch_(scratch) {}

  /// Fails: kTooLarge when there are more than there is room for, kStopped.
  [[nodiscard]] Status find(const Thresholds& thresholds, VectorPath path,
                            const Budget& budget) noexcept {
    Slots slots;
    auto body = [&](int chunk) {
      const int slot = slots.take();
      ChunkScratch scratch = scratch_.chunks[static_cast<std::size_t>(slot)];
      TopFinder finder(views_, thresholds, path, scratch, room(chunk), budget);
      counts_[static_cast<std::size_t>(chunk)] =
          finder.run(chunks_.begin(chunk), chunks_.end(chunk));
      slots.give_back(slot);
    };
    if (!for_each_chunk(budget, chunks_.count(), body)) return Status::kStopped;
    for (int i = 0; i < chunks_.count(); ++i) {
      if (counts_[static_cast<std::size_t>(i)] > room(i).size()) return Status::kTooLarge;
    }
    return Status::kOk;
  }

  void keep_connected(const Budget& budget) noexcept {
    int until_look = 0;
    for_each([&](const EdgePoint& top) {
      if (--until_look < 0) {
        until_look = kPointsPerLook;
        (void)budget.is_over();
      }
      if ((mark_of(top) & kStrongMark) != 0 && !budget.was_over())
        image::keep_connected(views_.marks, top.column, top.row, scratch_.stack);
    });
  }

  /// Copies what was kept. Where the closer look finds no step left, noise beside a real contour
  /// was taken for one: that cell is dropped.
  Result<int> collect(float jump_low_mm, std::span<EdgePoint> out) noexcept {
    constexpr float kLeastLeft = 0.5F;  // of the threshold it has passed
    std::size_t count = 0;
    for_each([&](const EdgePoint& top) {
      std::uint8_t& mark = mark_of(top);
      const bool is_step = top.kind == EdgeKind::kCrease || top.step_mm >= kLeastLeft * jump_low_mm;
      if ((mark & kWeakMark) != 0 || !is_step) {
        mark = 0;
        return;
      }
      if (count < out.size()) out[count] = top;
      ++count;
    });
    if (count > out.size()) return Status::kTooLarge;
    return static_cast<int>(count);
  }

 private:
  [[nodiscard]] std::uint8_t& mark_of(const EdgePoint& top) const noexcept {
    return views_.marks.row(top.row)[top.column];
  }
  [[nodiscard]] std::span<EdgePoint> room(int chunk) const noexcept {
    const auto before = [this](int row) {
      return static_cast<std::size_t>(row) * static_cast<std::size_t>(views_.marks.width_px) /
             kCellsPerTop;
    };
    const std::size_t first = before(chunks_.begin(chunk));
    return scratch_.tops.subspan(first, before(chunks_.end(chunk)) - first);
  }
  template <class Body>
  void for_each(const Body& body) const noexcept {
    for (int i = 0; i < chunks_.count(); ++i) {
      const std::span<EdgePoint> all = room(i);
      for (const EdgePoint& top : all.first(counts_[static_cast<std::size_t>(i)])) body(top);
    }
  }

  RowChunks chunks_;
  const Views& views_;
  const EdgeScratch& scratch_;
  std::array<std::size_t, kChunkCountMax> counts_{};
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
                         VectorPath path, const Budget& budget) noexcept {
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
  if (scratch.failed()) return Status::kOutOfMemory;

  const Thresholds thresholds{config.jump_low_mm,
                              config.jump_high_mm,
                              tangent(config.crease_low_rad),
                              tangent(config.crease_high_rad),
                              static_cast<float>(cell_mm),
                              config.crease_high_rad > 0.0F};
  const Views views{filled_mm, missing, kind_out};
  TopLists lists(views, s);
  if (const Status found = lists.find(thresholds, path, budget); found != Status::kOk) return found;
  lists.keep_connected(budget);
  if (budget.was_over()) return Status::kStopped;
  return lists.collect(config.jump_low_mm, out);
}

}  // namespace flatpose::image
