#include "flatpose/rectify/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
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

/// Two rows of the scan, and the quads between them that take more than a glance.
struct Scratch {
  ScanRow above, below;
  std::span<std::int32_t> lists;

  Scratch(Arena& arena, int width_px) noexcept
      : above(ScanRow::take(arena, width_px)),
        below(ScanRow::take(arena, width_px)),
        lists(arena.take<std::int32_t>(4 * list_size(width_px))) {}

  static std::size_t list_size(int width_px) noexcept {
    return static_cast<std::size_t>(width_px) + kRowPadding;
  }
  [[nodiscard]] QuadList list(int which) const noexcept {
    const std::size_t size = lists.size() / 4;
    std::int32_t* const first = lists.data() + 2 * static_cast<std::size_t>(which) * size;
    return {first, first + size, 0};
  }
};

/// Paints quad i, whose edges hold as given, one triangle after the other.
void paint_triangles(const QuadStrip& s, int i, std::int32_t edges, const HeightMap& out) noexcept {
  const unsigned triangles = kTrianglesOf[static_cast<unsigned>(edges)];
  const std::int32_t source = s.source_index + i * s.source_right;
  const auto above = [&](int k, std::int32_t index) {
    return Corner{s.u_above[k], s.v_above[k], s.z_above_mm[k], index};
  };
  const auto below = [&](int k, std::int32_t index) {
    return Corner{s.u_below[k], s.v_below[k], s.z_below_mm[k], index};
  };
  const Corner a = above(i, source), b = above(i + 1, source + s.source_right);
  const Corner c = below(i + 1, source + s.source_right + s.source_down);
  const Corner d = below(i, source + s.source_down);
  if (triangles == (kAbc | kAcd)) return paint_quad(out, a, b, c, d);
  if ((triangles & kAbc) != 0) paint_triangle(out, a, b, c);
  if ((triangles & kAcd) != 0) paint_triangle(out, a, c, d);
  if ((triangles & kAbd) != 0) paint_triangle(out, a, b, d);
  if ((triangles & kBcd) != 0) paint_triangle(out, b, c, d);
}

void paint_strip(const RowKernels& kernels, const QuadStrip& strip, const EdgeLimits& limits,
                 const Scratch& scratch, const HeightMap& out) noexcept {
  const MapCells cells(out);
  QuadList several = scratch.list(0);
  QuadList rest = scratch.list(1);
  kernels.paint_single_cells(strip, limits, cells, several);
  kernels.paint_several_cells(strip, cells, several, rest);
  for (int i = 0; i < rest.count; ++i) paint_triangles(strip, rest.quad[i], rest.edges[i], out);
}

/// Every step-th row and column.
RangeImageView thinned(const RangeImageView& scan, int step_px) noexcept {
  RangeImageView thin = scan;
  thin.width_px = (scan.width_px + step_px - 1) / step_px;
  thin.height_px = (scan.height_px + step_px - 1) / step_px;
  thin.pixel_stride_bytes *= step_px;
  thin.row_stride_bytes *= step_px;
  return thin;
}

}  // namespace

Status validate(const PaintConfig& config) noexcept {
  const auto within = [](double value) { return value >= 0.0 && value <= 1e6; };
  return within(config.jump_mm) && within(config.max_slope) && within(config.max_gap_mm) &&
                 config.max_gap_mm > 0.0 && config.step_px >= 1 && config.step_px <= kStepMax_px
             ? Status::kOk
             : Status::kInvalidArgument;
}

std::size_t paint_required_bytes(int scan_width_px) noexcept {
  Arena arena = Arena::measuring();
  (void)Scratch(arena, std::max(scan_width_px, 0));
  return arena.required_bytes();
}

Status paint(const RangeImageView& scan, const Pose& work_T_scan, const PaintConfig& config,
             Arena& scratch, const HeightMap& out) noexcept {
  if (const Status status = validate(config); status != Status::kOk) return status;
  if (const Status status = check_arguments(scan, work_T_scan, out); status != Status::kOk)
    return status;
  const ArenaScope scope(scratch);
  const RangeImageView thin = thinned(scan, config.step_px);
  Scratch s(scratch, thin.width_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  clear(out);
  if (scan.size() == 0) return Status::kOk;

  const ScanToGrid to_grid(work_T_scan, out.grid);
  const EdgeLimits limits = edge_limits(config, out.grid.cell_mm);
  const RowKernels& kernels = row_kernels(config.vector_path);
  kernels.transform_row(to_grid, thin, 0, s.below);
  for (int row = 1; row < thin.height_px; ++row) {
    std::swap(s.above, s.below);
    kernels.transform_row(to_grid, thin, row, s.below);
    const QuadStrip strip{s.above.u.data(),    s.above.v.data(),
                          s.above.z_mm.data(), s.below.u.data(),
                          s.below.v.data(),    s.below.z_mm.data(),
                          thin.width_px - 1,   (row - 1) * config.step_px * scan.width_px,
                          config.step_px,      config.step_px * scan.width_px};
    paint_strip(kernels, strip, limits, s, out);
  }
  return Status::kOk;
}

}  // namespace flatpose::rectify
