#include "flatpose/rectify/quad_block.hpp"

#include <bit>
#include <cmath>

#include "flatpose/rectify/scan_row.hpp"

// Every loop here is written to become vectors: no branches, logic by & and |, selections by ?:,
// and arrays the compiler knows to be apart.

namespace flatpose::rectify {
namespace {

constexpr std::int32_t kAbc = kAb | kBc | kAc;
constexpr std::int32_t kAcd = kAc | kCd | kAd;
constexpr std::int32_t kAbd = kAb | kBd | kAd;
constexpr std::int32_t kBcd = kBc | kCd | kBd;

constexpr std::int32_t kNothing = static_cast<std::int32_t>(Finding::kNothing);
constexpr std::int32_t kOneCell = static_cast<std::int32_t>(Finding::kOneCell);
constexpr std::int32_t kTriangles = static_cast<std::int32_t>(Finding::kTriangles);

/// All ones for true. Masks are integers so that every selection is one of integers.
std::int32_t mask(bool condition) noexcept { return condition ? -1 : 0; }

std::int32_t smaller(std::int32_t a, std::int32_t b) noexcept { return a < b ? a : b; }
std::int32_t larger(std::int32_t a, std::int32_t b) noexcept { return a > b ? a : b; }

/// `a` where the mask is set, else `b`.
std::int32_t select(std::int32_t mask_of_a, std::int32_t a, std::int32_t b) noexcept {
  return (a & mask_of_a) | (b & ~mask_of_a);
}
float select(std::int32_t mask_of_a, float a, float b) noexcept {
  return std::bit_cast<float>(
      select(mask_of_a, std::bit_cast<std::int32_t>(a), std::bit_cast<std::int32_t>(b)));
}

/// False when an end is missing: its height is NaN.
std::int32_t holds(const EdgeLimits& limits, std::int32_t du, std::int32_t dv,
                   float dz_mm) noexcept {
  const float x = static_cast<float>(du);
  const float y = static_cast<float>(dv);
  const float length_squared = x * x + y * y;
  const float beyond_mm = std::fabs(dz_mm) - limits.jump_mm;
  return mask(length_squared <= limits.gap_squared) &
         (mask(beyond_mm <= 0.0F) |
          mask(beyond_mm * beyond_mm <= limits.slope_squared * length_squared));
}

std::int32_t same_side(float p, float q, float r) noexcept {
  return (mask(p >= 0.0F) & mask(q >= 0.0F) & mask(r >= 0.0F)) |
         (mask(p <= 0.0F) & mask(q <= 0.0F) & mask(r <= 0.0F));
}

}  // namespace

bool covers_any(const QuadBlock& block) noexcept {
  const int count = block.count;
  const std::int32_t* const u0 = block.u_above;
  const std::int32_t* const v0 = block.v_above;
  const std::int32_t* const u1 = block.u_below;
  const std::int32_t* const v1 = block.v_below;
  std::int32_t any = 0;
  for (int i = 0; i < count; ++i) {
    // No centre's column passes between four places that lie between the same two.
    const std::int32_t across = (u0[i] ^ u0[i + 1]) | (u0[i] ^ u1[i]) | (u0[i] ^ u1[i + 1]);
    const std::int32_t down = (v0[i] ^ v0[i + 1]) | (v0[i] ^ v1[i]) | (v0[i] ^ v1[i + 1]);
    any |= mask((across >> kUnitBits) != 0) & mask((down >> kUnitBits) != 0);
  }
  return any != 0;
}

void judge_edges(const QuadBlock& block, const EdgeLimits& edge_limits,
                 BlockFindings& out) noexcept {
  const EdgeLimits limits = edge_limits;
  const int count = block.count;
  const std::int32_t* const u0 = block.u_above;
  const std::int32_t* const v0 = block.v_above;
  const float* const z0 = block.z_above_mm;
  const std::int32_t* const u1 = block.u_below;
  const std::int32_t* const v1 = block.v_below;
  const float* const z1 = block.z_below_mm;
  std::int32_t* __restrict const edges = out.edges.data();
  for (int i = 0; i < count; ++i) {
    edges[i] = (holds(limits, u0[i + 1] - u0[i], v0[i + 1] - v0[i], z0[i + 1] - z0[i]) & kAb) |
               (holds(limits, u1[i + 1] - u1[i], v1[i + 1] - v1[i], z1[i + 1] - z1[i]) & kCd) |
               (holds(limits, u1[i] - u0[i], v1[i] - v0[i], z1[i] - z0[i]) & kAd);
  }
  for (int i = 0; i < count; ++i) {
    edges[i] |=
        (holds(limits, u1[i + 1] - u0[i + 1], v1[i + 1] - v0[i + 1], z1[i + 1] - z0[i + 1]) & kBc) |
        (holds(limits, u1[i + 1] - u0[i], v1[i + 1] - v0[i], z1[i + 1] - z0[i]) & kAc) |
        (holds(limits, u1[i] - u0[i + 1], v1[i] - v0[i + 1], z1[i] - z0[i + 1]) & kBd);
  }
}

void find_cells(const QuadBlock& block, const Grid& grid, BlockFindings& out) noexcept {
  const int count = block.count;
  const std::int32_t* const u0 = block.u_above;
  const std::int32_t* const v0 = block.v_above;
  const float* const z0 = block.z_above_mm;
  const std::int32_t* const u1 = block.u_below;
  const std::int32_t* const v1 = block.v_below;
  const float* const z1 = block.z_below_mm;
  const std::int32_t* __restrict const edges = out.edges.data();
  auto* __restrict const finding = reinterpret_cast<std::int32_t*>(out.finding.data());
  std::int32_t* __restrict const out_column = out.column.data();
  std::int32_t* __restrict const out_row = out.row.data();
  float* __restrict const out_height_mm = out.height_mm.data();
  std::int32_t* __restrict const nearest = out.nearest.data();
  const std::int32_t width_px = grid.width_px;
  const std::int32_t height_px = grid.height_px;
  for (int i = 0; i < count; ++i) {
    // Places are odd and centres even: the first centre beyond u is (u >> bits) + 1.
    const std::int32_t u_min = smaller(smaller(u0[i], u0[i + 1]), smaller(u1[i], u1[i + 1]));
    const std::int32_t u_max = larger(larger(u0[i], u0[i + 1]), larger(u1[i], u1[i + 1]));
    const std::int32_t v_min = smaller(smaller(v0[i], v0[i + 1]), smaller(v1[i], v1[i + 1]));
    const std::int32_t v_max = larger(larger(v0[i], v0[i + 1]), larger(v1[i], v1[i + 1]));
    const std::int32_t column = u_max >> kUnitBits;
    const std::int32_t row = v_max >> kUnitBits;
    const std::int32_t columns = column - (u_min >> kUnitBits);
    const std::int32_t rows = row - (v_min >> kUnitBits);
    const std::int32_t covers = mask(columns > 0) & mask(rows > 0);
    const std::int32_t one_cell = mask(columns == 1) & mask(rows == 1);
    const std::int32_t inside =
        mask(column >= 0) & mask(column < width_px) & mask(row >= 0) & mask(row < height_px);

    // Corners as seen from the centre; what overflows is not one cell, and not looked at.
    const std::int32_t u = column << kUnitBits;
    const std::int32_t v = row << kUnitBits;
    const float ax = static_cast<float>(u0[i] - u), ay = static_cast<float>(v0[i] - v);
    const float bx = static_cast<float>(u0[i + 1] - u), by = static_cast<float>(v0[i + 1] - v);
    const float cx = static_cast<float>(u1[i + 1] - u), cy = static_cast<float>(v1[i + 1] - v);
    const float dx = static_cast<float>(u1[i] - u), dy = static_cast<float>(v1[i] - v);
    // An edge function of the centre for every edge, and the doubled areas.
    const float ab = ax * by - ay * bx;
    const float bc = bx * cy - by * cx;
    const float cd = cx * dy - cy * dx;
    const float da = dx * ay - dy * ax;
    const float ac = ax * cy - ay * cx;
    const float area_abc = ab + bc - ac;
    const float area_acd = ac + cd + da;
    const std::int32_t may_abc = mask((edges[i] & kAbc) == kAbc);
    const std::int32_t may_acd = mask((edges[i] & kAcd) == kAcd);
    const std::int32_t in_abc = may_abc & same_side(ab, bc, -ac) & mask(area_abc != 0.0F);
    const std::int32_t in_acd = may_acd & same_side(ac, cd, da) & mask(area_acd != 0.0F);

    // The triangle over the centre: a, c, and b or d. On the diagonal both are right, unless the
    // quad is folded over itself.
    const float weight_third = select(in_abc, -ac, ac);
    const float weight_c = select(in_abc, ab, da);
    const float area = select(in_abc, area_abc, area_acd);
    const float third_mm = select(in_abc, z0[i + 1] - z0[i], z1[i] - z0[i]);
    const float third_x = select(in_abc, bx, dx);
    const float third_y = select(in_abc, by, dy);
    const std::int32_t folded = in_abc & in_acd & mask(area_abc * area_acd < 0.0F);
    const float rise = weight_third * third_mm + weight_c * (z1[i + 1] - z0[i]);
    out_height_mm[i] = z0[i] + rise / area;

    const float to_a = ax * ax + ay * ay;
    const float to_third = third_x * third_x + third_y * third_y;
    const float to_c = cx * cx + cy * cy;
    const std::int32_t third_is_nearer = mask(to_third < to_a);
    const float to_a_or_third = select(third_is_nearer, to_third, to_a);
    const std::int32_t a_or_third = third_is_nearer & select(in_abc, 1, 3);
    nearest[i] = select(mask(to_c < to_a_or_third), 2, a_or_third);

    // The second diagonal is another's business, and never better when the first has a triangle.
    const std::int32_t first = may_abc | may_acd;
    const std::int32_t second = mask((edges[i] & kAbd) == kAbd) | mask((edges[i] & kBcd) == kBcd);
    const std::int32_t simple = first & one_cell & ~folded;
    const std::int32_t hit = simple & inside & (in_abc | in_acd);
    const std::int32_t rest = covers & (first | second) & ~simple;
    finding[i] = (hit & kOneCell) | (rest & kTriangles) | kNothing;
    out_column[i] = column;
    out_row[i] = row;
  }
}

}  // namespace flatpose::rectify
