#pragma once
// A block of neighbouring quads between two scan rows, judged as many at a time as a vector holds.
// Most quads of a scan about as dense as the map hold one cell's centre or none: these are finished
// here; the rest is left to triangle.hpp. The loops over a block are in row_kernels.hpp.
//
// The arithmetic of the common case is exact in float: seen from the only centre in its box, a
// corner is less than a cell away, so places are odd numbers below 2^12, their products are below
// 2^24, and the difference of two (even, below 2^25) still has all its bits.

#include <cstdint>

#include "flatpose/rectify/height_map.hpp"

namespace flatpose::rectify {

inline constexpr int kBlock = 64;  // quads

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

/// The corners of `count` quads: entry i of each array is a or d of quad i, entry i + 1 its b or c.
/// kRowPadding entries more can be read.
struct QuadBlock {
  const std::int32_t* u_above;
  const std::int32_t* v_above;
  const float* z_above_mm;
  const std::int32_t* u_below;
  const std::int32_t* v_below;
  const float* z_below_mm;
  int count;
};

enum class Finding : std::int32_t {
  kNothing = 0,    ///< No cell's centre is covered.
  kOneCell = 1,    ///< The cell's height and nearest corner are found.
  kTriangles = 2,  ///< To be painted triangle by triangle.
};

struct BlockFindings {
  std::int32_t edges[kBlock];  ///< Bits of those that hold.
  Finding finding[kBlock];
  std::int32_t column[kBlock];
  std::int32_t row[kBlock];
  float height_mm[kBlock];
  std::int32_t nearest[kBlock];  ///< 0 to 3 for corners a to d.
};

}  // namespace flatpose::rectify
