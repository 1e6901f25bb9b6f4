#include "flatpose/rectify/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "flatpose/rectify/scan_row.hpp"
#include "flatpose/rectify/triangle.hpp"

namespace flatpose::rectify {
namespace {

// A quad's corners are a (above, left), b (above, right), c (below, right), d (below, left). The
// six edges that may hold, and the triangles that may be painted:
enum Edge : unsigned { kAb = 1, kCd = 2, kAd = 4, kBc = 8, kAc = 16, kBd = 32 };
enum Triangle : unsigned { kAbc = 1, kAcd = 2, kAbd = 4, kBcd = 8, kWhole = kAbc | kAcd };

constexpr unsigned triangles_of(unsigned edges) {
  const auto hold = [edges](unsigned wanted) { return (edges & wanted) == wanted; };
  const unsigned first = (hold(kAb | kBc | kAc) ? kAbc : 0U) | (hold(kAc | kCd | kAd) ? kAcd : 0U);
  const unsigned second = (hold(kAb | kBd | kAd) ? kAbd : 0U) | (hold(kBc | kCd | kBd) ? kBcd : 0U);
  const auto count = [](unsigned bits) { return (bits & 3U) % 2 + (bits & 3U) / 2; };
  return count(second >> 2U) > count(first) ? second : first;
}

constexpr std::array<std::uint8_t, 64> kTriangles = [] {
  std::array<std::uint8_t, 64> table{};
  for (unsigned edges = 0; edges < 64; ++edges)
    table[edges] = static_cast<std::uint8_t>(triangles_of(edges));
  return table;
}();

/// What an edge may measure, in units of the grid.
struct EdgeLimits {
  float jump_mm;
  float slope_squared;  // (mm per unit)^2
  float gap_squared;    // units^2

  EdgeLimits(const PaintConfig& config, double cell_mm) noexcept {
    const double mm_per_unit = cell_mm / kUnitsPerCell;
    const double slope = config.max_slope * mm_per_unit;
    const double gap = std::min(config.max_gap_mm / mm_per_unit, 4.0 * kReach_px * kUnitsPerCell);
    jump_mm = static_cast<float>(config.jump_mm);
    slope_squared = static_cast<float>(slope * slope);
    gap_squared = static_cast<float>(gap * gap);
  }

  /// False when an end is missing: its height is NaN.
  [[nodiscard]] bool hold(std::int32_t du, std::int32_t dv, float dz_mm) const noexcept {
    const float x = static_cast<float>(du);
    const float y = static_cast<float>(dv);
    const float length_squared = x * x + y * y;
    const float beyond_mm = std::fabs(dz_mm) - jump_mm;
    return (length_squared <= gap_squared) &
           ((beyond_mm <= 0.0F) | (beyond_mm * beyond_mm <= slope_squared * length_squared));
  }
};

using EdgeFlags = std::span<std::int32_t>;

/// along[c]: the edge from pixel c to c + 1 of a row holds.
void judge_along(const ScanRow& row, const EdgeLimits& limits, EdgeFlags along) noexcept {
  const std::int32_t* const u = row.u.data();
  const std::int32_t* const v = row.v.data();
  const float* const z_mm = row.z_mm.data();
  std::int32_t* const flags = along.data();
  const int count = static_cast<int>(row.u.size()) - 1;
  for (int c = 0; c < count; ++c)
    flags[c] = limits.hold(u[c + 1] - u[c], v[c + 1] - v[c], z_mm[c + 1] - z_mm[c])
                   ? std::int32_t{kAb}
                   : 0;
}

/// down[c]: the edge from pixel c of the row above to pixel c + shift of the row below holds.
void judge_down(const ScanRow& above, const ScanRow& below, int shift, const EdgeLimits& limits,
                std::int32_t flag, EdgeFlags down) noexcept {
  const int from = shift < 0 ? 1 : 0;
  const int to = shift > 0 ? 1 : 0;
  const std::int32_t* const u0 = above.u.data() + from;
  const std::int32_t* const v0 = above.v.data() + from;
  const float* const z0_mm = above.z_mm.data() + from;
  const std::int32_t* const u1 = below.u.data() + to;
  const std::int32_t* const v1 = below.v.data() + to;
  const float* const z1_mm = below.z_mm.data() + to;
  std::int32_t* const flags = down.data();
  const int count = static_cast<int>(above.u.size()) - (shift == 0 ? 0 : 1);
  for (int c = 0; c < count; ++c)
    flags[c] = limits.hold(u1[c] - u0[c], v1[c] - v0[c], z1_mm[c] - z0_mm[c]) ? flag : 0;
}

/// All ones when a row or column of cell centres passes between the smallest and the largest of the
/// four, else zero: none does when all lie between the same two.
std::int32_t spread(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) noexcept {
  const std::int32_t differing = ((a ^ b) | (a ^ c) | (a ^ d)) >> kUnitBits;
  return differing != 0 ? -1 : 0;
}

struct Buffers {
  ScanRow above, below;
  EdgeFlags along_above, along_below, down, diagonal_ac, diagonal_bd, edges;

  Buffers(Arena& arena, int width_px) noexcept
      : above(ScanRow::take(arena, width_px)), below(ScanRow::take(arena, width_px)) {
    for (EdgeFlags* flags : {&along_above, &along_below, &down, &diagonal_ac, &diagonal_bd, &edges})
      *flags = arena.take<std::int32_t>(static_cast<std::size_t>(width_px));
  }
};

/// Gathers the six edges of every quad between two rows; none where the quad covers no centre.
void gather_edges(const Buffers& b) noexcept {
  const std::int32_t* const u0 = b.above.u.data();
  const std::int32_t* const v0 = b.above.v.data();
  const std::int32_t* const u1 = b.below.u.data();
  const std::int32_t* const v1 = b.below.v.data();
  const std::int32_t* const ab = b.along_above.data();
  const std::int32_t* const cd = b.along_below.data();
  const std::int32_t* const down = b.down.data();
  const std::int32_t* const ac = b.diagonal_ac.data();
  const std::int32_t* const bd = b.diagonal_bd.data();
  std::int32_t* const edges = b.edges.data();
  const int count = static_cast<int>(b.edges.size()) - 1;
  for (int c = 0; c < count; ++c) {
    const std::int32_t holding = ab[c] | (2 * cd[c]) | down[c] | (2 * down[c + 1]) | ac[c] | bd[c];
    edges[c] = holding & spread(u0[c], u0[c + 1], u1[c], u1[c + 1]) &
               spread(v0[c], v0[c + 1], v1[c], v1[c + 1]);
  }
}

Corner corner(const ScanRow& row, int c, std::int32_t source_index) noexcept {
  return {row.u[c], row.v[c], row.z_mm[c], source_index};
}

/// Paints the quads between two scan rows whose first pixels are `source` and `source + width`.
void paint_strip(const Buffers& buffers, std::int32_t source, const HeightMap& out) noexcept {
  const int count = static_cast<int>(buffers.edges.size()) - 1;
  const int width_px = count + 1;
  for (int i = 0; i < count; ++i) {
    const unsigned triangles = kTriangles[static_cast<unsigned>(buffers.edges[i])];
    if (triangles == 0) continue;
    const Corner a = corner(buffers.above, i, source + i);
    const Corner b = corner(buffers.above, i + 1, source + i + 1);
    const Corner c = corner(buffers.below, i + 1, source + width_px + i + 1);
    const Corner d = corner(buffers.below, i, source + width_px + i);
    if (triangles == kWhole) {
      paint_quad(out, a, b, c, d);
      continue;
    }
    if ((triangles & kAbc) != 0) paint_triangle(out, a, b, c);
    if ((triangles & kAcd) != 0) paint_triangle(out, a, c, d);
    if ((triangles & kAbd) != 0) paint_triangle(out, a, b, d);
    if ((triangles & kBcd) != 0) paint_triangle(out, b, c, d);
  }
}

}  // namespace

Status validate(const PaintConfig& config) noexcept {
  const auto within = [](double value) { return value >= 0.0 && value <= 1e6; };
  return within(config.jump_mm) && within(config.max_slope) && within(config.max_gap_mm) &&
                 config.max_gap_mm > 0.0
             ? Status::kOk
             : Status::kInvalidArgument;
}

std::size_t paint_required_bytes(int scan_width_px) noexcept {
  Arena arena = Arena::measuring();
  (void)Buffers(arena, std::max(scan_width_px, 0));
  return arena.required_bytes();
}

Status paint(const RangeImageView& scan, const Pose& work_T_scan, const PaintConfig& config,
             Arena& scratch, const HeightMap& out) noexcept {
  if (const Status status = validate(config); status != Status::kOk) return status;
  if (const Status status = check_arguments(scan, work_T_scan, out); status != Status::kOk)
    return status;
  const ArenaScope scope(scratch);
  Buffers buffers(scratch, scan.width_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  clear(out);
  if (scan.size() == 0) return Status::kOk;

  const ScanToGrid to_grid(work_T_scan, out.grid);
  const EdgeLimits limits(config, out.grid.cell_mm);
  to_grid.transform(scan, 0, buffers.below);
  judge_along(buffers.below, limits, buffers.along_below);
  for (int row = 1; row < scan.height_px; ++row) {
    std::swap(buffers.above, buffers.below);
    std::swap(buffers.along_above, buffers.along_below);
    to_grid.transform(scan, row, buffers.below);
    judge_along(buffers.below, limits, buffers.along_below);
    judge_down(buffers.above, buffers.below, 0, limits, kAd, buffers.down);
    judge_down(buffers.above, buffers.below, 1, limits, kAc, buffers.diagonal_ac);
    judge_down(buffers.above, buffers.below, -1, limits, kBd, buffers.diagonal_bd);
    gather_edges(buffers);
    paint_strip(buffers, (row - 1) * scan.width_px, out);
  }
  return Status::kOk;
}

}  // namespace flatpose::rectify
