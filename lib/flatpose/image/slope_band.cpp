#include "flatpose/image/slope_band.hpp"

#include <algorithm>

#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

void continue_sides(int width_px, float* row) noexcept {
  std::fill_n(row - SlopeBand::kMargin_px, SlopeBand::kMargin_px + 1, row[1]);
  std::fill_n(row + width_px - 1, SlopeBand::kMargin_px + 1, row[width_px - 2]);
}

}  // namespace

SlopeBand SlopeBand::take(Arena& arena, int width_px, int row_count) noexcept {
  SlopeBand band;
  band.stride_px = width_px + 2 * kMargin_px;
  const std::size_t count =
      static_cast<std::size_t>(band.stride_px) * static_cast<std::size_t>(row_count);
  band.x = arena.take<float>(count).data();
  band.y = arena.take<float>(count).data();
  band.xy = arena.take<float>(2 * count).data();
  return band;
}

void SlopeBand::fill(ImageView<const float> height_mm, int row_begin_, int row_end_,
                     VectorPath path) noexcept {
  const RowKernels& kernels = row_kernels(path);
  const int last = height_mm.height_px - 2;
  row_begin = row_begin_;
  row_end = row_end_;
  const int begin = std::clamp(row_begin, 1, last);
  const int end = std::clamp(row_end, begin + 1, last + 1);
  for (int row = begin; row < end; ++row) {
    kernels.sobel(three_rows(height_mm, row), height_mm.width_px, x_row(row), y_row(row));
    continue_sides(height_mm.width_px, x_row(row));
    continue_sides(height_mm.width_px, y_row(row));
  }
  const auto repeat = [this](int from, int to) {
    std::copy_n(x_row(from) - kMargin_px, stride_px, x_row(to) - kMargin_px);
    std::copy_n(y_row(from) - kMargin_px, stride_px, y_row(to) - kMargin_px);
  };
  for (int row = row_begin; row < begin; ++row) repeat(begin, row);
  for (int row = end; row < row_end; ++row) repeat(end - 1, row);
  for (int row = row_begin; row < row_end; ++row) {
    const std::ptrdiff_t first = x_row(row) - kMargin_px - x;
    kernels.interleave(x + first, y + first, stride_px, xy + 2 * first);
  }
}

}  // namespace flatpose::image
