#include "flatpose/rectify/triangle.hpp"

#include <algorithm>

#include "flatpose/rectify/scan_row.hpp"

namespace flatpose::rectify {
namespace {

/// The cells whose centres lie in a box of places, clipped to a window; half-open.
struct CellBox {
  std::int32_t column_begin, column_end, row_begin, row_end;

  [[nodiscard]] bool empty() const noexcept {
    return (column_end <= column_begin) | (row_end <= row_begin);
  }
};

// Places are odd and centres even: the first centre right of u is (u >> bits) + 1.
/// Of three or four corners.
template <class... Corners>
inline CellBox box_of(const CellWindow& window, const Corner& first,
                      const Corners&... others) noexcept {
  std::int32_t u_min = first.u, u_max = first.u, v_min = first.v, v_max = first.v;
  ((u_min = std::min(u_min, others.u), u_max = std::max(u_max, others.u),
    v_min = std::min(v_min, others.v), v_max = std::max(v_max, others.v)),
   ...);
  return {std::max((u_min >> kUnitBits) + 1, window.column_begin),
          std::min((u_max >> kUnitBits) + 1, window.column_end),
          std::max((v_min >> kUnitBits) + 1, window.row_begin),
          std::min((v_max >> kUnitBits) + 1, window.row_end)};
}

/// A corner as seen from a cell's centre.
struct Seen {
  std::int64_t u, v;
  float z_mm;
  std::int32_t source_index;

  Seen(const Corner& corner, int column, int row) noexcept
      : u(corner.u - static_cast<std::int64_t>(column) * kUnitsPerCell),
        v(corner.v - static_cast<std::int64_t>(row) * kUnitsPerCell),
        z_mm(corner.z_mm),
        source_index(corner.source_index) {}
  [[nodiscard]] std::int64_t distance_squared() const noexcept { return u * u + v * v; }
};

/// Twice the signed area of the centre, a, b: the edge function of a->b there.
std::int64_t edge(const Seen& a, const Seen& b) noexcept { return a.u * b.v - a.v * b.u; }

bool same_side(std::int64_t p, std::int64_t q, std::int64_t r) noexcept {
  return ((p >= 0) & (q >= 0) & (r >= 0)) | ((p <= 0) & (q <= 0) & (r <= 0));
}

/// The mean of the corners' heights with weights whose sum is not zero.
float blend(std::int64_t weight_a, float a_mm, std::int64_t weight_b, float b_mm,
            std::int64_t weight_c, float c_mm) noexcept {
  const double base_mm = static_cast<double>(a_mm);
  const double rise = static_cast<double>(weight_b) * (static_cast<double>(b_mm) - base_mm) +
                      static_cast<double>(weight_c) * (static_cast<double>(c_mm) - base_mm);
  return static_cast<float>(base_mm + rise / static_cast<double>(weight_a + weight_b + weight_c));
}

std::int32_t nearest_source(const Seen& a, const Seen& b, const Seen& c) noexcept {
  const std::int64_t to_a = a.distance_squared();
  const std::int64_t to_b = b.distance_squared();
  const std::int64_t to_c = c.distance_squared();
  const std::int32_t a_or_b = to_b < to_a ? b.source_index : a.source_index;
  return to_c < std::min(to_a, to_b) ? c.source_index : a_or_b;
}

}  // namespace

void paint_triangle(const HeightMap& map, const CellWindow& window, const Corner& a,
                    const Corner& b, const Corner& c) noexcept {
  const CellBox box = box_of(window, a, b, c);
  if (box.empty()) return;
  const Seen a0(a, box.column_begin, box.row_begin);
  const Seen b0(b, box.column_begin, box.row_begin);
  const Seen c0(c, box.column_begin, box.row_begin);
  std::int64_t row_ab = edge(a0, b0);
  std::int64_t row_bc = edge(b0, c0);
  std::int64_t row_ca = edge(c0, a0);
  if (row_ab + row_bc + row_ca == 0) return;
  // One cell on, an edge function grows by the edge's extent across.
  const std::int64_t unit = kUnitsPerCell;
  const std::int64_t column_ab = unit * (a0.v - b0.v), down_ab = unit * (b0.u - a0.u);
  const std::int64_t column_bc = unit * (b0.v - c0.v), down_bc = unit * (c0.u - b0.u);
  const std::int64_t column_ca = unit * (c0.v - a0.v), down_ca = unit * (a0.u - c0.u);
  for (int row = box.row_begin; row < box.row_end; ++row) {
    std::int64_t ab = row_ab, bc = row_bc, ca = row_ca;
    for (int column = box.column_begin; column < box.column_end; ++column) {
      if (same_side(ab, bc, ca)) {
        const std::int32_t source =
            nearest_source(Seen(a, column, row), Seen(b, column, row), Seen(c, column, row));
        put(map, column, row, blend(bc, a.z_mm, ca, b.z_mm, ab, c.z_mm), source);
      }
      ab += column_ab, bc += column_bc, ca += column_ca;
    }
    row_ab += down_ab, row_bc += down_bc, row_ca += down_ca;
  }
}

void paint_quad(const HeightMap& map, const CellWindow& window, const Corner& a, const Corner& b,
                const Corner& c, const Corner& d) noexcept {
  const CellBox box = box_of(window, a, b, c, d);
  for (int row = box.row_begin; row < box.row_end; ++row) {
    for (int column = box.column_begin; column < box.column_end; ++column) {
      const Seen a0(a, column, row), b0(b, column, row), c0(c, column, row), d0(d, column, row);
      const std::int64_t ab = edge(a0, b0), bc = edge(b0, c0), ca = edge(c0, a0);
      const std::int64_t cd = edge(c0, d0), da = edge(d0, a0), ac = -ca;
      const bool in_abc = same_side(ab, bc, ca) & (ab + bc + ca != 0);
      const bool in_acd = same_side(ac, cd, da) & (ac + cd + da != 0);
      if (in_abc) {
        put(map, column, row, blend(bc, a.z_mm, ca, b.z_mm, ab, c.z_mm),
            nearest_source(a0, b0, c0));
      }
      if (in_acd) {
        put(map, column, row, blend(cd, a.z_mm, da, c.z_mm, ac, d.z_mm),
            nearest_source(a0, c0, d0));
      }
    }
  }
}

}  // namespace flatpose::rectify
