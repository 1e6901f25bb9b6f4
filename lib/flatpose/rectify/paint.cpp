#include "flatpose/rectify/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "flatpose/rectify/row_kernels.hpp"
#include "flatpose/rectify/triangle.hpp"

namespace flatpose::rectify {
namespace {

EdgeLimits edge_limits(const PaintConfig& config, double cell_mm) noexcept {
  const double mm_per_unit = cell_mm / kUnitsPerCell;
  const double slope = config.max_slope * mm_per_unit;
  const double gap = std::min(config.max_gap_mm / mm_per_unit, 4.0 * kReach_px * kUnitsPerCell);
  return {static_cast<float>(config.jump_mm), static_cast<float>(slope * slope),
          static_cast<float>(gap * gap)};
}

// The triangles of a quad, of its first diagonal ac and its second bd.
enum Triangle : unsigned { kAbc = 1, kAcd = 2, kAbd = 4, kBcd = 8 };

constexpr unsigned triangles_of(unsigned edges) {
  const auto hold = [edges](unsigned wanted) { return (edges & wanted) == wanted; };
  const unsigned first = (hold(kAb | kBc | kAc) ? kAbc : 0U) | (hold(kAc | kCd | kAd) ? kAcd : 0U);
  const unsigned second = (hold(kAb | kBd | kAd) ? kAbd : 0U) | (hold(kBc | kCd | kBd) ? kBcd : 0U);
  const auto count = [](unsigned bits) { return (bits & 3U) % 2 + (bits & 3U) / 2; };
  return count(second >> 2U) > count(first) ? second : first;
}

constexpr std::array<std::uint8_t, 64> kTrianglesOf = [] {
  std::array<std::uint8_t, 64> table{};
  for (unsigned edges = 0; edges < 64; ++edges)
    table[edges] = static_cast<std::uint8_t>(triangles_of(edges));
  return table;
}();

/// Two rows of the scan and what goes with them.
struct Strip {
  ScanRow above, below;
  std::int32_t source_index;  // of the first pixel above
  int width_px;

  [[nodiscard]] QuadBlock block(int first, int count) const noexcept {
    return {above.u.data() + first,
            above.v.data() + first,
            above.z_mm.data() + first,
            below.u.data() + first,
            below.v.data() + first,
            below.z_mm.data() + first,
            count};
  }
  [[nodiscard]] Corner corner_above(int i) const noexcept {
    return {above.u[i], above.v[i], above.z_mm[i], source_index + i};
  }
  [[nodiscard]] Corner corner_below(int i) const noexcept {
    return {below.u[i], below.v[i], below.z_mm[i], source_index + width_px + i};
  }
};

/// Paints quad i, whose edges hold as given, one triangle after the other.
void paint_triangles(const Strip& strip, int i, std::int32_t edges, const HeightMap& out) noexcept {
  const unsigned triangles = kTrianglesOf[static_cast<unsigned>(edges)];
  const Corner a = strip.corner_above(i), b = strip.corner_above(i + 1);
  const Corner c = strip.corner_below(i + 1), d = strip.corner_below(i);
  if (triangles == (kAbc | kAcd)) return paint_quad(out, a, b, c, d);
  if ((triangles & kAbc) != 0) paint_triangle(out, a, b, c);
  if ((triangles & kAcd) != 0) paint_triangle(out, a, c, d);
  if ((triangles & kAbd) != 0) paint_triangle(out, a, b, d);
  if ((triangles & kBcd) != 0) paint_triangle(out, b, c, d);
}

void paint_strip(const RowKernels& kernels, const Strip& strip, const EdgeLimits& limits,
                 const HeightMap& out) noexcept {
  const std::int32_t source_of_corner[] = {0, 1, strip.width_px + 1, strip.width_px};
  const int quad_count = strip.width_px - 1;
  BlockFindings findings;
  const HeightMap map = out;  // its address is nobody's: stores into its images do not change it
  for (int first = 0; first < quad_count; first += kBlock) {
    const int count = std::min(kBlock, quad_count - first);
    const QuadBlock block = strip.block(first, count);
    if (!kernels.covers_any(block)) continue;
    kernels.find_cells(block, limits, out.grid, findings);
    for (int i = 0; i < count; ++i) {
      if (findings.finding[i] == Finding::kOneCell) {
        put(map, findings.column[i], findings.row[i], findings.height_mm[i],
            strip.source_index + first + i + source_of_corner[findings.nearest[i]]);
      } else if (findings.finding[i] == Finding::kTriangles) {
        paint_triangles(strip, first + i, findings.edges[i], out);
      }
    }
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
  const int width_px = std::max(scan_width_px, 0);
  (void)ScanRow::take(arena, width_px);
  (void)ScanRow::take(arena, width_px);
  return arena.required_bytes();
}

Status paint(const RangeImageView& scan, const Pose& work_T_scan, const PaintConfig& config,
             Arena& scratch, const HeightMap& out) noexcept {
  if (const Status status = validate(config); status != Status::kOk) return status;
  if (const Status status = check_arguments(scan, work_T_scan, out); status != Status::kOk)
    return status;
  const ArenaScope scope(scratch);
  Strip strip{ScanRow::take(scratch, scan.width_px), ScanRow::take(scratch, scan.width_px), 0,
              scan.width_px};
  if (scratch.failed()) return Status::kOutOfMemory;
  clear(out);
  if (scan.size() == 0) return Status::kOk;

  const ScanToGrid to_grid(work_T_scan, out.grid);
  const EdgeLimits limits = edge_limits(config, out.grid.cell_mm);
  const RowKernels& kernels = row_kernels(config.vector_path);
  kernels.transform_row(to_grid, scan, 0, strip.below);
  for (int row = 1; row < scan.height_px; ++row) {
    std::swap(strip.above, strip.below);
    kernels.transform_row(to_grid, scan, row, strip.below);
    strip.source_index = (row - 1) * scan.width_px;
    paint_strip(kernels, strip, limits, out);
  }
  return Status::kOk;
}

}  // namespace flatpose::rectify
