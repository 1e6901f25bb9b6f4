#include "flatpose/image/fill.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "flatpose/image/glance.hpp"
#include "flatpose/image/row_kernels.hpp"
#include "flatpose/rectify/slots.hpp"

namespace flatpose::image {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
// Columns are shared out in few wide chunks: narrow ones make short rows.
constexpr int kColumnChunks = 2;
constexpr int kColumnsMin = 64;

/// Some columns of a map; what is carried down and up stays in its column.
struct Columns {
  int begin;
  int end;
};

// Missing cells, which hold what lies above, take the lowest of that, their run's neighbours and
// what is carried up; those that nothing valid is in line with take the floor. Runs go on beyond
// the columns.
void take_lowest(const std::uint8_t* missing, int width_px, Columns columns, const float* carried,
                 float floor_mm, float* filled_mm) noexcept {
  const int count = columns.end - columns.begin;
  for_each_run(missing + columns.begin, count, [&](int first, int last) {
    const int begin = columns.begin + first;
    const int end = columns.begin + last;
    int before = begin - 1;
    if (first == 0) {
      while (before >= 0 && missing[before] != 0) --before;
    }
    const int after = last == count ? next_clear(missing, end, width_px) : end;
    const float left = before >= 0 ? filled_mm[before] : kNothing;
    const float right = after < width_px ? filled_mm[after] : kNothing;
    for (int x = begin; x < end; ++x) {
      const float lowest = std::min(std::min(std::min(filled_mm[x], left), carried[x]), right);
      filled_mm[x] = lowest < kNothing ? lowest : floor_mm;
    }
  });
}

/// A row of what is carried, and one of the lowest height of each column.
std::span<float> take_rows(Arena& arena, int width_px) noexcept {
  return arena.take<float>(2 * static_cast<std::size_t>(width_px));
}

}  // namespace

void reserve_fill_scratch(Arena& arena, int width_px) noexcept { (void)take_rows(arena, width_px); }

Status fill_missing(ImageView<const float> height_mm, ImageView<float> filled_mm,
                    ImageView<std::uint8_t> missing, Arena& scratch, VectorPath path,
                    const Budget& budget) noexcept {
  if (!same_shape(height_mm, filled_mm) || !same_shape(height_mm, missing)) {
    return Status::kShapeMismatch;
  }
  if (height_mm.empty()) return Status::kTooFewPoints;
  const ArenaScope scope(scratch);
  const int w = height_mm.width_px;
  const int h = height_mm.height_px;
  const std::span<float> rows = take_rows(scratch, w);
  if (rows.empty()) return Status::kOutOfMemory;
  float* const carried = rows.data();
  float* const lowest_mm = carried + w;

  const RowKernels& kernels = row_kernels(path);
  const rectify::RowChunks chunks(w,
                                  std::max(kColumnsMin, (w + kColumnChunks - 1) / kColumnChunks));
  std::array<bool, rectify::kChunkCountMax> any_missing{};
  std::fill(rows.begin(), rows.end(), kNothing);
  auto fill_from_above = [&](int chunk) {
    const int x = chunks.begin(chunk);
    bool any = false;
    for (int y = 0; y < h && !budget.is_over_at(y); ++y) {
      any |= kernels.carry_down(height_mm.row(y) + x, chunks.end(chunk) - x, carried + x,
                                lowest_mm + x, filled_mm.row(y) + x, missing.row(y) + x);
    }
    any_missing[static_cast<std::size_t>(chunk)] = any;
  };
  if (!for_each_chunk(budget, chunks.count(), fill_from_above)) return Status::kStopped;
  if (std::find(any_missing.begin(), any_missing.end(), true) == any_missing.end())
    return Status::kOk;
  const float floor_mm = *std::min_element(lowest_mm, lowest_mm + w);
  const bool found = floor_mm < kNothing;
  std::fill_n(carried, w, kNothing);
  auto fill_from_below = [&](int chunk) {
    const Columns columns{chunks.begin(chunk), chunks.end(chunk)};
    const int x = columns.begin;
    for (int y = h - 1; y >= 0 && !budget.is_over_at(y); --y) {
      take_lowest(missing.row(y), w, columns, carried, found ? floor_mm : 0.0F, filled_mm.row(y));
      kernels.carry_up(missing.row(y) + x, filled_mm.row(y) + x, columns.end - x, carried + x);
    }
  };
  if (!for_each_chunk(budget, chunks.count(), fill_from_below)) return Status::kStopped;
  return found ? Status::kOk : Status::kTooFewPoints;
}

}  // namespace flatpose::image
