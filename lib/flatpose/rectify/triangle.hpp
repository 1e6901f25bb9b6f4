#pragma once
// Fills the cells of a height map whose centres lie in a triangle. Inside is decided in integers
// and the border belongs to the triangle, so neighbours leave no crack between them.

#include <cstdint>

#include "flatpose/rectify/height_map.hpp"

namespace flatpose::rectify {

/// A corner of a triangle; the place in units of 1 / kUnitsPerCell, odd (see scan_row.hpp).
struct Corner {
  std::int32_t u = 0;
  std::int32_t v = 0;
  float z_mm = 0.0F;
  std::int32_t source_index = kNoSource;
};

/// Gives the cell to a surface that covers it, if none as high has it.
inline void put(const HeightMap& map, int column, int row, float z_mm,
                std::int32_t source_index) noexcept {
  float& height_mm = map.height_mm.row(row)[column];
  if (height_mm >= z_mm) return;  // false for a missing height, which is NaN
  height_mm = z_mm;
  map.source_index.row(row)[column] = source_index;
}

/// Paints the triangle a, b, c of either winding into a window of the map; none of no area.
/// Cost: the cells of its box.  Thread: one painter a map.
void paint_triangle(const HeightMap& map, const CellWindow& window, const Corner& a,
                    const Corner& b, const Corner& c) noexcept;
inline void paint_triangle(const HeightMap& map, const Corner& a, const Corner& b,
                           const Corner& c) noexcept {
  paint_triangle(map, whole(map.grid), a, b, c);
}

/// Paints the triangles a, b, c and a, c, d as paint_triangle() would one after the other.
void paint_quad(const HeightMap& map, const CellWindow& window, const Corner& a, const Corner& b,
                const Corner& c, const Corner& d) noexcept;
inline void paint_quad(const HeightMap& map, const Corner& a, const Corner& b, const Corner& c,
                       const Corner& d) noexcept {
  paint_quad(map, whole(map.grid), a, b, c, d);
}

}  // namespace flatpose::rectify
