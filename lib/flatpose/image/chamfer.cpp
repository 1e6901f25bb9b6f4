#include "flatpose/image/chamfer.hpp"

#include <algorithm>
#include <limits>

#include "flatpose/image/chamfer_steps.hpp"
#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

using Distance = std::uint16_t;
constexpr int kFar = std::numeric_limits<Distance>::max();

inline Distance plus(Distance distance, int step) noexcept {
  const int sum = distance + step;
  return static_cast<Distance>(sum < kFar ? sum : kFar);
}

// Distances of a row by way of the finished row before it; no dependence within the row.
void from_previous_row(const Distance* __restrict previous, int width_px,
                       Distance* __restrict row) noexcept {
  const auto put = [&](int x, int left, int right) {
    const Distance diagonal = plus(std::min(previous[left], previous[right]), kDiagonal_third_px);
    const Distance straight = plus(previous[x], kStraight_third_px);
    row[x] = std::min(row[x], std::min(diagonal, straight));
  };
  const int last = width_px - 1;
  put(0, 0, std::min(1, last));
  for (int x = 1; x < last; ++x) put(x, x - 1, x + 1);
  if (last > 0) put(last, last - 1, last);
}

void along_row(int first, int end, int step, Distance* row) noexcept {
  Distance carried = kFar;
  for (int x = first; x != end; x += step) {
    carried = std::min(row[x], plus(carried, kStraight_third_px));
    row[x] = carried;
  }
}

}  // namespace

Status chamfer_distance(ImageView<const std::uint8_t> mask,
                        ImageView<std::uint16_t> distance_third_px) noexcept {
  if (!same_shape(mask, distance_third_px)) return Status::kShapeMismatch;
  if (mask.empty()) return Status::kOk;
  const int w = mask.width_px;
  const int h = mask.height_px;
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* set = mask.row(y);
    Distance* row = distance_third_px.row(y);
    for (int x = 0; x < w; ++x) row[x] = static_cast<Distance>(set[x] != 0 ? 0 : kFar);
    if (y > 0) from_previous_row(distance_third_px.row(y - 1), w, row);
    along_row(0, w, 1, row);
  }
  for (int y = h - 1; y >= 0; --y) {
    Distance* row = distance_third_px.row(y);
    if (y + 1 < h) from_previous_row(distance_third_px.row(y + 1), w, row);
    along_row(w - 1, -1, -1, row);
  }
  return Status::kOk;
}

Status chamfer_distance(ImageView<const std::uint8_t> mask,
                        ImageView<std::uint8_t> distance_third_px, VectorPath path) noexcept {
  if (!same_shape(mask, distance_third_px)) return Status::kShapeMismatch;
  if (mask.empty()) return Status::kOk;
  const RowKernels& kernels = row_kernels(path);
  const int w = mask.width_px;
  const int last = mask.height_px - 1;
  // A row without one before it is its own: that shortens nothing.
  for (int y = 0; y <= last; ++y) {
    const std::uint8_t* set = mask.row(y);
    std::uint8_t* row = distance_third_px.row(y);
    for (int x = 0; x < w; ++x) row[x] = set[x] != 0 ? std::uint8_t{0} : std::uint8_t{255};
    kernels.shorten_bytes_forward(distance_third_px.row(y > 0 ? y - 1 : y), w, row);
  }
  for (int y = last; y >= 0; --y)
    kernels.shorten_bytes_backward(distance_third_px.row(y < last ? y + 1 : y), w,
                                   distance_third_px.row(y));
  return Status::kOk;
}

}  // namespace flatpose::image
