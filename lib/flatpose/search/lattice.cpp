#include "flatpose/search/lattice.hpp"

#include <algorithm>

namespace flatpose::search {
namespace {

int floor_quotient(int value, int divisor) noexcept {
  const int quotient = value / divisor;
  return quotient * divisor > value ? quotient - 1 : quotient;
}

}  // namespace

std::int32_t Lattice::offset_bytes(int dx, int dy) const noexcept {
  const int columns = floor_quotient(dx, stride_px);
  const int rows = floor_quotient(dy, stride_px);
  const int phase = (dy - rows * stride_px) * stride_px + (dx - columns * stride_px);
  return phase * static_cast<std::int32_t>(phase_bytes()) + rows * row_bytes + columns;
}

Lattice make_lattice(int width_px, int height_px, int stride_px, int reach_px) noexcept {
  const auto places = [stride_px](int cells) { return (cells + stride_px - 1) / stride_px; };
  Lattice lattice;
  lattice.stride_px = stride_px;
  lattice.width = places(width_px);
  lattice.height = places(height_px);
  lattice.reach = places(std::clamp(reach_px, 1, kReachMax_px));
  lattice.row_bytes = lattice.padded_width() + 2 * lattice.reach;
  lattice.row_count = lattice.height + 2 * lattice.reach;
  return lattice;
}

void fill_margins(int width_px, int height_px, const Lattice& lattice, std::uint8_t outside,
                  std::uint8_t* phases) noexcept {
  const int s = lattice.stride_px;
  for (int phase = 0; phase < s * s; ++phase) {
    std::uint8_t* from = phases + static_cast<std::size_t>(phase) * lattice.phase_bytes();
    std::uint8_t* const end = from + lattice.phase_bytes();
    const int columns = (width_px - phase % s + s - 1) / s;
    const int rows = (height_px - phase / s + s - 1) / s;
    // From the end of each row of cells to the next one's begin at once.
    for (int row = 0; row < rows; ++row) {
      std::uint8_t* const cells = phases + static_cast<std::size_t>(phase) * lattice.phase_bytes() +
                                  lattice.byte_of(0, row);
      std::fill(from, cells, outside);
      from = cells + columns;
    }
    std::fill(from, end, outside);
  }
}

void spread(ImageView<const std::uint8_t> image, const Lattice& lattice, std::uint8_t outside,
            std::uint8_t* phases) noexcept {
  fill_margins(image.width_px, image.height_px, lattice, outside, phases);
  const int s = lattice.stride_px;
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* source = image.row(y);
    for (int phase_x = 0; phase_x < s; ++phase_x) {
      const auto phase = static_cast<std::size_t>(y % s * s + phase_x);
      std::uint8_t* target = phases + phase * lattice.phase_bytes() + lattice.byte_of(0, y / s);
      const int count = (image.width_px - phase_x + s - 1) / s;
      for (int i = 0; i < count; ++i) target[i] = source[i * s + phase_x];
    }
  }
}

}  // namespace flatpose::search
