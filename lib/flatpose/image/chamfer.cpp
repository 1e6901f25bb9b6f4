#include "flatpose/image/chamfer.hpp"

#include <algorithm>
#include <limits>

namespace flatpose::image {
namespace {

constexpr int kStraight_third_px = 3;
constexpr int kDiagonal_third_px = 4;

template <class T>
inline T plus(T distance, int step) noexcept {
  constexpr int kMax = std::numeric_limits<T>::max();
  const int sum = distance + step;
  return static_cast<T>(sum < kMax ? sum : kMax);
}

// Distances of a row by way of the finished row before it; no dependence within the row.
template <class T>
void from_previous_row(const T* __restrict previous, int width_px, T* __restrict row) noexcept {
  const auto put = [&](int x, int left, int right) {
    const T diagonal = plus(std::min(previous[left], previous[right]), kDiagonal_third_px);
    const T straight = plus(previous[x], kStraight_third_px);
    row[x] = std::min(row[x], std::min(diagonal, straight));
  };
  const int last = width_px - 1;
  put(0, 0, std::min(1, last));
  for (int x = 1; x < last; ++x) put(x, x - 1, x + 1);
  if (last > 0) put(last, last - 1, last);
}

template <class T>
void along_row(int first, int end, int step, T* row) noexcept {
  T carried = std::numeric_limits<T>::max();
  for (int x = first; x != end; x += step) {
    carried = std::min(row[x], plus(carried, kStraight_third_px));
    row[x] = carried;
  }
}

template <class T>
Status chamfer(ImageView<const std::uint8_t> mask, ImageView<T> distance) noexcept {
  if (!same_shape(mask, distance)) return Status::kShapeMismatch;
  if (mask.empty()) return Status::kOk;
  const int w = mask.width_px;
  const int h = mask.height_px;
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* set = mask.row(y);
    T* row = distance.row(y);
    for (int x = 0; x < w; ++x) row[x] = set[x] != 0 ? T{0} : std::numeric_limits<T>::max();
    if (y > 0) from_previous_row(distance.row(y - 1), w, row);
    along_row(0, w, 1, row);
  }
  for (int y = h - 1; y >= 0; --y) {
    T* row = distance.row(y);
    if (y + 1 < h) from_previous_row(distance.row(y + 1), w, row);
    along_row(w - 1, -1, -1, row);
  }
  return Status::kOk;
}

}  // namespace

Status chamfer_distance(ImageView<const std::uint8_t> mask,
                        ImageView<std::uint16_t> distance_third_px) noexcept {
  return chamfer(mask, distance_third_px);
}

Status chamfer_distance(ImageView<const std::uint8_t> mask,
                        ImageView<std::uint8_t> distance_third_px) noexcept {
  return chamfer(mask, distance_third_px);
}

}  // namespace flatpose::image
