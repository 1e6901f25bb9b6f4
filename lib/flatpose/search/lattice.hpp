#pragma once
// Where the bytes of the search's images lie. A hypothesis stands at every stride-th cell, a
// template point anywhere, so an image is kept in stride x stride phases: cell (sX + px, sY + py)
// is byte (X, Y) of phase (px, py). For neighbouring places the same template point then lies in
// neighbouring bytes, and a block of places is a contiguous load.
//
//        image, s = 2            phases
//        a b a b a b             a a a   b b b        Every phase has a margin of `reach` bytes all
//        c d c d c d      ->     a a a   b b b        round, so that no shift leaves the memory.
//        a b a b a b             c c c   d d d
//        c d c d c d             c c c   d d d

#include <cstddef>
#include <cstdint>

#include "flatpose/core/image_view.hpp"

namespace flatpose::search {

inline constexpr int kBlockSize = 64;  ///< Places evaluated together.
inline constexpr int kStrideMax_px = 4;
/// Template points farther from the anchor are left out. A multiple of every stride.
inline constexpr int kReachMax_px = 192;

struct Lattice {
  int stride_px = 1;
  int width = 0;  ///< Places along x.
  int height = 0;
  int reach = 0;      ///< Margin in places.
  int row_bytes = 0;  ///< Of a phase, margins and the last block's rest counted in.
  int row_count = 0;

  [[nodiscard]] int padded_width() const noexcept {
    return (width + kBlockSize - 1) / kBlockSize * kBlockSize;
  }
  [[nodiscard]] std::size_t phase_bytes() const noexcept {
    return static_cast<std::size_t>(row_bytes) * static_cast<std::size_t>(row_count);
  }
  [[nodiscard]] std::size_t image_bytes() const noexcept {
    return static_cast<std::size_t>(stride_px) * static_cast<std::size_t>(stride_px) *
           phase_bytes();
  }
  /// The byte of a place in an image's first phase.
  [[nodiscard]] std::size_t byte_of(int column, int row) const noexcept {
    return static_cast<std::size_t>(row + reach) * static_cast<std::size_t>(row_bytes) +
           static_cast<std::size_t>(column + reach);
  }
  /// From a place's byte to that of the cell (dx, dy) away. Within +-reach_px() it stays inside.
  [[nodiscard]] std::int32_t offset_bytes(int dx, int dy) const noexcept;
  [[nodiscard]] int reach_px() const noexcept { return reach * stride_px; }
};

/// The lattice over an image of cells, for shifts up to `reach_px` (at most kReachMax_px).
[[nodiscard]] Lattice make_lattice(int width_px, int height_px, int stride_px,
                                   int reach_px) noexcept;

/// Writes `outside` to all of an image's phases that no cell fills.
/// Memory: `phases` holds lattice.image_bytes().
void fill_margins(int width_px, int height_px, const Lattice& lattice, std::uint8_t outside,
                  std::uint8_t* phases) noexcept;

/// Copies an image into its phases; what lies outside reads `outside`.
/// Memory: `phases` holds lattice.image_bytes().
void spread(ImageView<const std::uint8_t> image, const Lattice& lattice, std::uint8_t outside,
            std::uint8_t* phases) noexcept;

}  // namespace flatpose::search
