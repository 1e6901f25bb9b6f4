#include "flatpose/image/dark_pit.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "flatpose/image/glance.hpp"
#include "flatpose/image/lost_points.hpp"
#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

constexpr int kSideMin_px = 3;

// What is known of a missing cell.
constexpr std::uint8_t kLevelRow = 1;  // in a run of its row that is wide and level
constexpr std::uint8_t kPit = 2;
// A pit, were there nothing higher at one end of its diagonal.
constexpr std::uint8_t kShadowFalling = 3;
constexpr std::uint8_t kShadowRising = 4;

struct DarkPitScratch {
  ImageView<std::uint8_t> marks;
  std::span<std::uint8_t> wide;     // by column: whether a run as wide as a pit begins there
  std::span<std::uint8_t> has_pit;  // by row
  // By column: of the largest square of pits that ends there; of this row and that above.
  std::span<std::uint8_t> side_px;
};

DarkPitScratch lay_out(Arena& arena, int width_px, int height_px) noexcept {
  const auto width = static_cast<std::size_t>(width_px);
  return {arena.take_image<std::uint8_t>(width_px, height_px), arena.take<std::uint8_t>(width),
          arena.take<std::uint8_t>(static_cast<std::size_t>(height_px)),
          arena.take<std::uint8_t>(2 * width)};
}

// Whether most of the cells beyond the end of a gap, `step` apart from `first` on, were seen: where
// most of the scan is lost, a gap is nothing but more of that.
constexpr int kBeside_px = 5;
constexpr int kBesideSeenMin = 3;
bool is_firm(const std::uint8_t* first, std::ptrdiff_t step, int count) noexcept {
  int seen_count = 0;
  for (int i = 0; i < std::min(count, kBeside_px); ++i) seen_count += first[i * step] == 0 ? 1 : 0;
  return seen_count >= kBesideSeenMin;
}

void mark_level_rows(const DarkPitScratch& s, ImageView<const std::uint8_t> missing,
                     ImageView<const float> filled_mm, int side_min_px, float level_mm,
                     const RowKernels& kernels, const Budget& budget) noexcept {
  for (int y = 0; y < missing.height_px && !budget.is_over_at(y); ++y) {
    const std::uint8_t* row = missing.row(y);
    const float* z_mm = filled_mm.row(y);
    std::uint8_t* mark = s.marks.row(y);
    std::fill_n(mark, missing.width_px, std::uint8_t{0});
    if (!kernels.find_wide(row, missing.width_px, side_min_px, s.wide.data())) continue;
    for_each_run(s.wide.data(), missing.width_px, [&](int begin, int last_begin) {
      const int end = last_begin + side_min_px - 1;
      if (begin == 0 || !is_firm(row + begin - 1, -1, begin) ||
          !is_firm(row + end, 1, missing.width_px - end)) {
        return;
      }
      const float highest_mm = std::max(z_mm[begin - 1], z_mm[end]);
      for (int i = begin; i < end; ++i) mark[i] = highest_mm - z_mm[i] <= level_mm ? kLevelRow : 0;
    });
  }
}

// Whether a run of missing cells of a column has firm ends.
bool is_firm_run(ImageView<const std::uint8_t> missing, int x, int begin, int end) noexcept {
  return begin > 0 && is_firm(missing.row(begin - 1) + x, -missing.stride_px, begin) &&
         is_firm(missing.row(end) + x, missing.stride_px, missing.height_px - end);
}

// Where rows and columns agree there may be a pit. Each run of a column is judged once, from the
// first of its cells that is marked.
void mark_level_columns(ImageView<const std::uint8_t> missing, ImageView<const float> filled_mm,
                        int side_min_px, float level_mm, ImageView<std::uint8_t> marks,
                        const Budget& budget) noexcept {
  for (int y = 0; y < missing.height_px && !budget.is_over_at(y); ++y) {
    for_each_set(marks.row(y), missing.width_px, [&](int x) {
      if (marks(x, y) != kLevelRow) return;
      int begin = y;
      while (begin > 0 && missing(x, begin - 1) != 0) --begin;
      int end = y + 1;
      while (end < missing.height_px && missing(x, end) != 0) ++end;
      const bool counts = end - begin >= side_min_px && end < missing.height_px &&
                          is_firm_run(missing, x, begin, end);
      const float highest_mm = counts ? std::max(filled_mm(x, begin - 1), filled_mm(x, end)) : 0.0F;
      for (int i = y; i < end; ++i) {
        if (marks(x, i) != kLevelRow) continue;
        marks(x, i) = counts && highest_mm - filled_mm(x, i) <= level_mm ? kPit : std::uint8_t{0};
      }
    });
  }
}

void note_rows_with_pits(const DarkPitScratch& s) noexcept {
  const auto width = static_cast<std::size_t>(s.marks.width_px);
  for (int y = 0; y < s.marks.height_px; ++y) {
    s.has_pit[static_cast<std::size_t>(y)] =
        std::memchr(s.marks.row(y), kPit, width) != nullptr ? std::uint8_t{1} : std::uint8_t{0};
  }
}

// A shadow lies beside what casts it: where a diagonal (dx, 1) of missing cells ends at something
// higher, they are in no pit but in `shadow`. It is judged once, from the first pit on it.
void clear_shadows(ImageView<const std::uint8_t> missing, ImageView<const float> filled_mm,
                   float level_mm, int dx, std::uint8_t shadow, ImageView<std::uint8_t> marks,
                   const Budget& budget) noexcept {
  const auto is_missing = [&](int x, int y) {
    return missing.contains(x, y) && missing(x, y) != 0;
  };
  const auto height_mm = [&](int x, int y) {
    return missing.contains(x, y) ? filled_mm(x, y) : -std::numeric_limits<float>::infinity();
  };
  for (int y = 0; y < missing.height_px && !budget.is_over_at(y); ++y) {
    for_each_set(marks.row(y), missing.width_px, [&](int x) {
      if (marks(x, y) != kPit) return;
      const auto mark = [&](int i) -> std::uint8_t& { return marks(x + i * dx, y + i); };
      int before = -1;
      while (is_missing(x + before * dx, y + before) && mark(before) != kPit &&
             mark(before) != shadow) {
        --before;
      }
      if (is_missing(x + before * dx, y + before)) return;
      int end = 1;
      while (is_missing(x + end * dx, y + end)) ++end;
      const float highest_mm =
          std::max(height_mm(x + before * dx, y + before), height_mm(x + end * dx, y + end));
      for (int i = 0; i < end; ++i) {
        if (mark(i) == kPit && highest_mm - filled_mm(x + i * dx, y + i) > level_mm)
          mark(i) = shadow;
      }
    });
  }
}

// Lowers what lies in a square of pits as large as none is by accident. The largest square that
// ends in a cell is one more than the smallest of those that end to its left, above, and between.
void lower_squares(const DarkPitScratch& s, int side_min_px, float drop_mm,
                   ImageView<std::uint8_t> missing, ImageView<float> filled_mm,
                   const Budget& budget) noexcept {
  const auto lower = [&](int end_x, int end_y) {
    for (int y = end_y - side_min_px + 1; y <= end_y; ++y) {
      for (int x = end_x - side_min_px + 1; x <= end_x; ++x) {
        if (missing(x, y) == kDarkPit) continue;
        missing(x, y) = kDarkPit;
        filled_mm(x, y) -= drop_mm;
      }
    }
  };
  constexpr int kSideMax_px = 255;
  const auto width = static_cast<std::size_t>(missing.width_px);
  std::uint8_t* above_px = s.side_px.data();
  std::uint8_t* here_px = above_px + width;
  std::fill(s.side_px.begin(), s.side_px.end(), std::uint8_t{0});
  bool above_is_empty = true;
  for (int y = 0; y < missing.height_px && !budget.is_over_at(y); ++y) {
    const bool is_empty = s.has_pit[static_cast<std::size_t>(y)] == 0;
    if (is_empty && above_is_empty) continue;
    above_is_empty = is_empty;
    std::fill_n(here_px, width, std::uint8_t{0});
    for_each_set(s.marks.row(y), missing.width_px, [&](int x) {
      if (s.marks(x, y) != kPit) return;
      const int smallest_px =
          x > 0 ? std::min({here_px[x - 1], above_px[x - 1], above_px[x]}) : std::uint8_t{0};
      here_px[x] = static_cast<std::uint8_t>(std::min(1 + smallest_px, kSideMax_px));
      if (here_px[x] >= side_min_px) lower(x, y);
    });
    std::swap(here_px, above_px);
  }
}

// What adjoins a pit and could be one belongs to it: the tips of the gap between three that touch
// are narrower than any square. Sweeps down and up reach as far as the gap turns back twice.
void lower_adjoining(const DarkPitScratch& s, float drop_mm, ImageView<std::uint8_t> missing,
                     ImageView<float> filled_mm, const Budget& budget) noexcept {
  const ImageView<const std::uint8_t> marks = s.marks;
  const auto is_lowered = [&](int x, int y) {
    return missing.contains(x, y) && missing(x, y) == kDarkPit;
  };
  bool has_grown = true;
  const auto adjoin = [&](int x, int y, int dx, int dy) {
    if (marks(x, y) != kPit || missing(x, y) == kDarkPit) return;
    if (!is_lowered(x + dx, y) && !is_lowered(x, y + dy)) return;
    missing(x, y) = kDarkPit;
    filled_mm(x, y) -= drop_mm;
    has_grown = true;
  };
  constexpr int kRoundCount = 2;
  for (int round = 0; has_grown && round < kRoundCount; ++round) {
    has_grown = false;
    for (int y = 0; y < missing.height_px && !budget.is_over_at(y); ++y) {
      if (s.has_pit[static_cast<std::size_t>(y)] == 0) continue;
      for_each_set(marks.row(y), marks.width_px, [&](int x) { adjoin(x, y, -1, -1); });
      for_each_set_backward(marks.row(y), marks.width_px, [&](int x) { adjoin(x, y, 1, -1); });
    }
    for (int y = missing.height_px - 1; y >= 0 && !budget.is_over_at(y); --y) {
      if (s.has_pit[static_cast<std::size_t>(y)] == 0) continue;
      for_each_set(marks.row(y), marks.width_px, [&](int x) { adjoin(x, y, -1, 1); });
      for_each_set_backward(marks.row(y), marks.width_px, [&](int x) { adjoin(x, y, 1, 1); });
    }
  }
}

}  // namespace

void reserve_dark_pit_scratch(Arena& arena, int width_px, int height_px) noexcept {
  (void)lay_out(arena, width_px, height_px);
}

Status lower_dark_pits(const DarkPitConfig& config, Arena& scratch, ImageView<std::uint8_t> missing,
                       ImageView<float> filled_mm, VectorPath path, const Budget& budget) noexcept {
  if (!same_shape(missing, filled_mm)) return Status::kShapeMismatch;
  if (!(config.level_mm > 0.0F) || !(config.drop_mm > config.level_mm))
    return Status::kInvalidArgument;
  if (missing.empty()) return Status::kOk;
  const ArenaScope scope(scratch);
  const DarkPitScratch s = lay_out(scratch, missing.width_px, missing.height_px);
  if (scratch.failed()) return Status::kOutOfMemory;

  const int side_min_px = accidental_side_px(missing, kSideMin_px, path);
  mark_level_rows(s, missing, filled_mm, side_min_px, config.level_mm, row_kernels(path), budget);
  mark_level_columns(missing, filled_mm, side_min_px, config.level_mm, s.marks, budget);
  clear_shadows(missing, filled_mm, config.level_mm, 1, kShadowFalling, s.marks, budget);
  clear_shadows(missing, filled_mm, config.level_mm, -1, kShadowRising, s.marks, budget);
  if (budget.was_over()) return Status::kStopped;
  note_rows_with_pits(s);
  lower_squares(s, side_min_px, config.drop_mm, missing, filled_mm, budget);
  lower_adjoining(s, config.drop_mm, missing, filled_mm, budget);
  return budget.was_over() ? Status::kStopped : Status::kOk;
}

}  // namespace flatpose::image
