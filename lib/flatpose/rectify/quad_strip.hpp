#pragma once
// The quads between two scan rows, painted as many at a time as a vector holds. Most quads of a
// scan about as dense as the map hold one cell's centre or none; those with up to two along each
// axis are collected and painted after them; the rest is left to triangle.hpp. The loops are in
// row_kernels.hpp.
//
// The arithmetic of one centre is exact in float: seen from the only centre in its box, a
// corner is less than a cell away, so places are odd numbers below 2^12, their products are below
// 2^24, and the difference of two (even, below 2^25) still has all its bits. That of several is
// done in 32-bit integers and doubles, exactly as in triangle.hpp.

#include <cstdint>

#include "flatpose/rectify/height_map.hpp"

namespace flatpose::rectify {

/// A quad's corners are a (above, left), b (above, right), c (below, right), d (below, left); bits
/// of its edges that hold.
inline constexpr std::int32_t kAb = 1;
inline constexpr std::int32_t kBc = 2;
inline constexpr std::int32_t kCd = 4;
inline constexpr std::int32_t kAd = 8;
inline constexpr std::int32_t kAc = 16;
inline constexpr std::int32_t kBd = 32;

/// What an edge may measure, in units of the grid.
struct EdgeLimits {
  float jump_mm;
  float slope_squared;  ///< (mm per unit)^2
  float gap_squared;    ///< units^2
};

/// The quads between two rows: entry i of each array is a or d of quad i, entry i + 1 its b or c.
/// kRowPadding entries more can be read.
struct QuadStrip {
  const std::int32_t* u_above;
  const std::int32_t* v_above;
  const float* z_above_mm;
  const std::int32_t* u_below;
  const std::int32_t* v_below;
  const float* z_below_mm;
  int count;
  std::int32_t source_index;  ///< The scan's pixel that is corner a of quad 0.
  std::int32_t source_right;  ///< From a to b.
  std::int32_t source_down;   ///< From a to d.
};

/// The cells of a height map, or of a part of it, as the loops write them.
struct MapCells {
  float* height_mm;  ///< Of cell (0, 0) of the whole map.
  std::int32_t* source_index;
  std::int32_t height_stride_px;
  std::int32_t source_stride_px;
  CellWindow window;  ///< Nothing outside is written.

  MapCells(const HeightMap& map, const CellWindow& window_) noexcept
      : height_mm(map.height_mm.data),
        source_index(map.source_index.data),
        height_stride_px(static_cast<std::int32_t>(map.height_mm.stride_px)),
        source_stride_px(static_cast<std::int32_t>(map.source_index.stride_px)),
        window(window_) {}
  explicit MapCells(const HeightMap& map) noexcept : MapCells(map, whole(map.grid)) {}
};

/// Quads of a strip that are left to another loop, with the bits of their edges that hold.
struct QuadList {
  std::int32_t* quad;  ///< Room for those of a strip, and kRowPadding more.
  std::int32_t* edges;
  int count;
};

}  // namespace flatpose::rectify
