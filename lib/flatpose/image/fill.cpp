#include "flatpose/image/fill.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatpose::image {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

// Fills a row from above and from the left; returns whether a cell was missing. `carried` holds the
// last valid height of every column, `lowest` that of the map so far.
bool fill_forward(const float* height_mm, int width_px, float* carried, float* filled_mm,
                  std::uint8_t* missing, float& lowest_mm) noexcept {
  int missing_count = 0;
  float lowest = lowest_mm;
  for (int x = 0; x < width_px; ++x) {
    const float z = height_mm[x];
    const bool valid = std::fabs(z) < kNothing;  // false for NaN too
    const float kept = valid ? z : carried[x];
    carried[x] = kept;
    filled_mm[x] = kept;
    missing[x] = valid ? 0 : 1;
    missing_count += valid ? 0 : 1;
    lowest = valid && z < lowest ? z : lowest;
  }
  lowest_mm = lowest;
  if (missing_count == 0) return false;
  float left = kNothing;
  for (int x = 0; x < width_px; ++x) {
    left = missing[x] != 0 ? left : filled_mm[x];
    filled_mm[x] = std::min(filled_mm[x], left);
  }
  return true;
}

// The same from below and from the right, and from nowhere.
void fill_backward(int width_px, float* carried, float* filled_mm, const std::uint8_t* missing,
                   float lowest_mm) noexcept {
  int missing_count = 0;
  for (int x = 0; x < width_px; ++x) {
    const float kept = missing[x] != 0 ? carried[x] : filled_mm[x];
    carried[x] = kept;
    filled_mm[x] = std::min(filled_mm[x], kept);
    missing_count += missing[x];
  }
  if (missing_count == 0) return;
  float right = kNothing;
  for (int x = width_px - 1; x >= 0; --x) {
    right = missing[x] != 0 ? right : filled_mm[x];
    const float z = std::min(filled_mm[x], right);
    filled_mm[x] = z < kNothing ? z : lowest_mm;
  }
}

}  // namespace

void reserve_fill_scratch(Arena& arena, int width_px) noexcept {
  (void)arena.take<float>(static_cast<std::size_t>(width_px));
}

Status fill_missing(ImageView<const float> height_mm, ImageView<float> filled_mm,
                    ImageView<std::uint8_t> missing, Arena& scratch) noexcept {
  if (!same_shape(height_mm, filled_mm) || !same_shape(height_mm, missing)) {
    return Status::kShapeMismatch;
  }
  if (height_mm.empty()) return Status::kTooFewPoints;
  const ArenaScope scope(scratch);
  const int w = height_mm.width_px;
  const int h = height_mm.height_px;
  const std::span<float> carried = scratch.take<float>(static_cast<std::size_t>(w));
  if (carried.empty()) return Status::kOutOfMemory;

  float lowest_mm = kNothing;
  bool any_missing = false;
  std::fill(carried.begin(), carried.end(), kNothing);
  for (int y = 0; y < h; ++y) {
    any_missing |= fill_forward(height_mm.row(y), w, carried.data(), filled_mm.row(y),
                                missing.row(y), lowest_mm);
  }
  if (!any_missing) return Status::kOk;
  const bool all_missing = lowest_mm == kNothing;
  if (all_missing) lowest_mm = 0.0F;
  std::fill(carried.begin(), carried.end(), kNothing);
  for (int y = h - 1; y >= 0; --y) {
    fill_backward(w, carried.data(), filled_mm.row(y), missing.row(y), lowest_mm);
  }
  return all_missing ? Status::kTooFewPoints : Status::kOk;
}

}  // namespace flatpose::image
