#include "flatpose/image/fill.hpp"

#include <algorithm>
#include <limits>

#include "flatpose/image/glance.hpp"
#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

// Missing cells, which hold what lies above, take the lowest of that, their run's neighbours and
// what is carried up; those that nothing valid is in line with take the floor.
void take_lowest(const std::uint8_t* missing, int width_px, const float* carried, float floor_mm,
                 float* filled_mm) noexcept {
  for_each_run(missing, width_px, [&](int begin, int end) {
    const float left = begin > 0 ? filled_mm[begin - 1] : kNothing;
    const float right = end < width_px ? filled_mm[end] : kNothing;
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
                    ImageView<std::uint8_t> missing, Arena& scratch, VectorPath path) noexcept {
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
  bool any_missing = false;
  std::fill(rows.begin(), rows.end(), kNothing);
  for (int y = 0; y < h; ++y) {
    any_missing |= kernels.carry_down(height_mm.row(y), w, carried, lowest_mm, filled_mm.row(y),
                                      missing.row(y));
  }
  if (!any_missing) return Status::kOk;
  const float floor_mm = *std::min_element(lowest_mm, lowest_mm + w);
  const bool found = floor_mm < kNothing;
  std::fill_n(carried, w, kNothing);
  for (int y = h - 1; y >= 0; --y) {
    take_lowest(missing.row(y), w, carried, found ? floor_mm : 0.0F, filled_mm.row(y));
    kernels.carry_up(missing.row(y), filled_mm.row(y), w, carried);
  }
  return found ? Status::kOk : Status::kTooFewPoints;
}

}  // namespace flatpose::image
