#include "flatpose/image/fill.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "flatpose/image/glance.hpp"
#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

// Missing cells, which hold what lies above, take the lowest of that, their run's neighbours and
// what is carried up. Returns whether one is left with nothing.
bool take_lowest(const std::uint8_t* missing, int width_px, const float* carried,
                 float* filled_mm) noexcept {
  bool nothing_left = false;
  for_each_run(missing, width_px, [&](int begin, int end) {
    const float left = begin > 0 ? filled_mm[begin - 1] : kNothing;
    const float right = end < width_px ? filled_mm[end] : kNothing;
    for (int x = begin; x < end; ++x) {
      filled_mm[x] = std::min(std::min(std::min(filled_mm[x], left), carried[x]), right);
      nothing_left |= filled_mm[x] == kNothing;
    }
  });
  return nothing_left;
}

float lowest_of(ImageView<const float> image) noexcept {
  constexpr int kLanes = 16;
  std::array<float, kLanes> lowest;
  lowest.fill(kNothing);
  const auto take = [](float& low, float z) { low = z < low ? z : low; };
  for (int y = 0; y < image.height_px; ++y) {
    const float* row = image.row(y);
    int x = 0;
    for (; x + kLanes <= image.width_px; x += kLanes) {
      for (int k = 0; k < kLanes; ++k) take(lowest[k], row[x + k]);
    }
    for (; x < image.width_px; ++x) take(lowest[0], row[x]);
  }
  return *std::min_element(lowest.begin(), lowest.end());
}

/// Rows in which cells are left with nothing; half-open.
struct RowRange {
  int begin = 0;
  int end = 0;
};

// What nothing valid is in line with takes the lowest height there is. False when there is none.
bool take_floor(ImageView<const std::uint8_t> missing, RowRange rows,
                ImageView<float> filled_mm) noexcept {
  const float lowest_mm = lowest_of(filled_mm);
  const bool found = lowest_mm < kNothing;
  const float floor_mm = found ? lowest_mm : 0.0F;
  for (int y = rows.begin; y < rows.end; ++y) {
    for_each_set(missing.row(y), missing.width_px, [&](int x) {
      float& z = filled_mm.row(y)[x];
      z = z < kNothing ? z : floor_mm;
    });
  }
  return found;
}

}  // namespace

void reserve_fill_scratch(Arena& arena, int width_px) noexcept {
  (void)arena.take<float>(static_cast<std::size_t>(width_px));
}

Status fill_missing(ImageView<const float> height_mm, ImageView<float> filled_mm,
                    ImageView<std::uint8_t> missing, Arena& scratch, VectorPath path) noexcept {
  if (!same_shape(height_mm, filled_mm) || !same_shape(height_mm, missing)) {
    return Status::kShapeMismatch;
  }
  if (height_mm.empty()) return Status::kTooFewPoints;
  const ArenaScope scope(scratch);
  const int w = height_mm.width_px;
  const int h = height_mm.height_px;
  const std::span<float> carried = scratch.take<float>(static_cast<std::size_t>(w));
  if (carried.empty()) return Status::kOutOfMemory;

  const RowKernels& kernels = row_kernels(path);
  bool any_missing = false;
  std::fill(carried.begin(), carried.end(), kNothing);
  for (int y = 0; y < h; ++y) {
    any_missing |=
        kernels.carry_down(height_mm.row(y), w, carried.data(), filled_mm.row(y), missing.row(y));
  }
  if (!any_missing) return Status::kOk;
  RowRange left;
  std::fill(carried.begin(), carried.end(), kNothing);
  for (int y = h - 1; y >= 0; --y) {
    if (take_lowest(missing.row(y), w, carried.data(), filled_mm.row(y)))
      left = {y, std::max(left.end, y + 1)};
    kernels.carry_up(missing.row(y), filled_mm.row(y), w, carried.data());
  }
  const bool all_missing = left.end > 0 && !take_floor(missing, left, filled_mm);
  return all_missing ? Status::kTooFewPoints : Status::kOk;
}

}  // namespace flatpose::image
