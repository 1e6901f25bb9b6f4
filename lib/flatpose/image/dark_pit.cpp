#include "flatpose/image/dark_pit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace flatpose::image {
namespace {

constexpr int kWidthMin_px = 3;
constexpr int kWidthMax_px = 15;

struct DarkPitScratch {
  ImageView<std::uint8_t> level_in_row;  // 1 in runs of a row that are wide and level
  std::span<std::int32_t> run_px;        // missing cells above, by column
};

DarkPitScratch lay_out(Arena& arena, int width_px, int height_px) noexcept {
  return {arena.take_image<std::uint8_t>(width_px, height_px),
          arena.take<std::int32_t>(static_cast<std::size_t>(width_px))};
}

double single_share(ImageView<const std::uint8_t> missing) noexcept {
  std::int64_t count = 0;
  for (int y = 1; y + 1 < missing.height_px; ++y) {
    const std::uint8_t* above = missing.row(y - 1);
    const std::uint8_t* row = missing.row(y);
    const std::uint8_t* below = missing.row(y + 1);
    int in_row = 0;
    for (int x = 1; x + 1 < missing.width_px; ++x) {
      in_row += row[x] & ~(row[x - 1] | row[x + 1] | above[x] | below[x]) & 1;
    }
    count += in_row;
  }
  return static_cast<double>(count) / missing.width_px / missing.height_px;
}

// A gap this wide is no accident: less than one is expected in the image when half the points of
// its square have to be lost.
int accidental_width_px(ImageView<const std::uint8_t> missing) noexcept {
  constexpr double kArrangements = 20.0;
  const double share = single_share(missing);
  const double places = kArrangements * missing.width_px * missing.height_px;
  int width_px = kWidthMin_px;
  for (; width_px < kWidthMax_px; width_px += 2) {
    double expected = places;
    for (int point = 0; point < width_px * width_px / 2; ++point) expected *= share;
    if (expected < 1.0) break;
  }
  return width_px;
}

// Whether kFirm_px cells from `first` on, `step` cells apart, were all seen: where most of the scan
// is lost, a gap is nothing but more of that.
constexpr int kFirm_px = 2;
bool is_firm(const std::uint8_t* first, std::ptrdiff_t step) noexcept {
  for (int i = 0; i < kFirm_px; ++i) {
    if (first[i * step] != 0) return false;
  }
  return true;
}

void mark_level_runs(ImageView<const std::uint8_t> missing, ImageView<const float> filled_mm,
                     int width_min_px, float level_mm, ImageView<std::uint8_t> marks) noexcept {
  for (int y = 0; y < missing.height_px; ++y) {
    const std::uint8_t* row = missing.row(y);
    const float* z_mm = filled_mm.row(y);
    std::uint8_t* mark = marks.row(y);
    std::fill_n(mark, missing.width_px, std::uint8_t{0});
    for (int x = kFirm_px; x < missing.width_px; ++x) {
      if (row[x] == 0 || row[x - 1] != 0) continue;
      int end = x + 1;
      while (end < missing.width_px && row[end] != 0) ++end;
      const bool level = end + kFirm_px <= missing.width_px && is_firm(row + x - 1, -1) &&
                         is_firm(row + end, 1) && std::fabs(z_mm[x - 1] - z_mm[end]) <= level_mm;
      if (level && end - x >= width_min_px) std::fill(mark + x, mark + end, std::uint8_t{1});
      x = end;
    }
  }
}

// A run of a column has ended above row `end`: what lies in it is lowered where rows and columns
// agree.
void lower_run(ImageView<const std::uint8_t> marks, const DarkPitConfig& config, int x, int begin,
               int end, ImageView<std::uint8_t> missing, ImageView<float> filled_mm) noexcept {
  if (begin < kFirm_px || end + kFirm_px > missing.height_px) return;
  if (!is_firm(missing.row(begin - 1) + x, -missing.stride_px) ||
      !is_firm(missing.row(end) + x, missing.stride_px)) {
    return;
  }
  const float above_mm = filled_mm(x, begin - 1);
  const float below_mm = filled_mm(x, end);
  if (std::fabs(above_mm - below_mm) > config.level_mm) return;
  const float highest_mm = std::max(above_mm, below_mm);
  for (int y = begin; y < end; ++y) {
    float& z_mm = filled_mm(x, y);  // the lowest of the four sides
    if (marks(x, y) == 0 || highest_mm - z_mm > config.level_mm) continue;
    z_mm -= config.drop_mm;
    missing(x, y) = kDarkPit;
  }
}

}  // namespace

void reserve_dark_pit_scratch(Arena& arena, int width_px, int height_px) noexcept {
  (void)lay_out(arena, width_px, height_px);
}

Status lower_dark_pits(const DarkPitConfig& config, Arena& scratch, ImageView<std::uint8_t> missing,
                       ImageView<float> filled_mm) noexcept {
  if (!same_shape(missing, filled_mm)) return Status::kShapeMismatch;
  if (!(config.level_mm > 0.0F) || !(config.drop_mm > config.level_mm))
    return Status::kInvalidArgument;
  if (missing.empty()) return Status::kOk;
  const ArenaScope scope(scratch);
  const DarkPitScratch s = lay_out(scratch, missing.width_px, missing.height_px);
  if (scratch.failed()) return Status::kOutOfMemory;

  const int width_min_px = accidental_width_px(missing);
  mark_level_runs(missing, filled_mm, width_min_px, config.level_mm, s.level_in_row);
  std::fill(s.run_px.begin(), s.run_px.end(), 0);
  for (int y = 0; y < missing.height_px; ++y) {
    const std::uint8_t* row = missing.row(y);
    for (int x = 0; x < missing.width_px; ++x) {
      std::int32_t& run_px = s.run_px[x];
      if (row[x] != 0) {
        ++run_px;
        continue;
      }
      if (run_px >= width_min_px)
        lower_run(s.level_in_row, config, x, y - run_px, y, missing, filled_mm);
      run_px = 0;
    }
  }
  return Status::kOk;
}

}  // namespace flatpose::image
