#include "flatpose/rectify/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "flatpose/rectify/row_kernels.hpp"
#include "flatpose/rectify/slots.hpp"
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

  Scratch() = default;
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

using Scratches = std::array<Scratch, kChunkCountMax>;

Scratches take_scratches(Arena& arena, int width_px) noexcept {
  Scratches scratches;
  for (Scratch& scratch : scratches) scratch = Scratch(arena, width_px);
  return scratches;
}

/// Paints quad i, whose edges hold as given, one triangle after the other.
void paint_triangles(const QuadStrip& s, int i, std::int32_t edges, const CellWindow& window,
                     const HeightMap& out) noexcept {
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
  if (triangles == (kAbc | kAcd)) return paint_quad(out, window, a, b, c, d);
  if ((triangles & kAbc) != 0) paint_triangle(out, window, a, b, c);
  if ((triangles & kAcd) != 0) paint_triangle(out, window, a, c, d);
  if ((triangles & kAbd) != 0) paint_triangle(out, window, a, b, d);
  if ((triangles & kBcd) != 0) paint_triangle(out, window, b, c, d);
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

/// Parts of the map that are painted side by side: each by itself, from all strips that reach it.
struct Parts {
  bool by_rows = true;
  RowChunks bands;

  [[nodiscard]] CellWindow window(const Grid& grid, int part) const noexcept {
    const std::int32_t begin = bands.begin(part), end = bands.end(part);
    return by_rows ? CellWindow{0, grid.width_px, begin, end}
                   : CellWindow{begin, end, 0, grid.height_px};
  }
};

class Painter {
 public:
  Painter(const RangeImageView& scan, const Pose& work_T_scan, const PaintConfig& config,
          const HeightMap& out) noexcept
      : scan_(scan),
        thin_(thinned(scan, config.step_px)),
        step_px_(config.step_px),
        reach_(config.reach != nullptr && config.reach->scan_height_px == scan.height_px
                   ? config.reach
                   : nullptr),
        group_rows_(reach_ != nullptr ? reach_->rows_per_group() : 1),
        to_grid_(work_T_scan, out.grid),
        limits_(edge_limits(config, out.grid.cell_mm)),
        kernels_(row_kernels(config.vector_path)),
        out_(out) {}

  [[nodiscard]] Status run(const Scratches& scratches, const Budget& budget) const noexcept {
    const Parts parts = choose_parts();
    Slots slots;
    auto body = [&](int part) {
      const int slot = slots.take();
      Scratch scratch = scratches[static_cast<std::size_t>(slot)];
      paint(parts.window(out_.grid, part), scratch, budget);
      slots.give_back(slot);
    };
    return for_each_chunk(budget, parts.bands.count(), body) ? Status::kOk : Status::kStopped;
  }

 private:
  [[nodiscard]] int strip_count() const noexcept { return thin_.height_px - 1; }

  /// Rows or columns, if few strips reach more than one part; else the whole map at once.
  [[nodiscard]] Parts choose_parts() const noexcept {
    constexpr int kBlock_px = 16;  // cells in a cache line
    const Grid& grid = out_.grid;
    const Parts whole_map{true, RowChunks(grid.height_px, grid.height_px)};
    if (reach_ == nullptr) return whole_map;
    const Parts by_rows{true, RowChunks(grid.height_px, kBlock_px)};
    const Parts by_columns{false, RowChunks(grid.width_px, kBlock_px)};
    const auto is_worth_it = [this](int visits) { return 2 * visits <= 3 * strip_count(); };
    if (is_worth_it(visit_count(by_rows))) return by_rows;
    return is_worth_it(visit_count(by_columns)) ? by_columns : whole_map;
  }
  [[nodiscard]] int visit_count(const Parts& parts) const noexcept {
    int count = 0;
    for (int part = 0; part < parts.bands.count(); ++part) {
      const CellWindow window = parts.window(out_.grid, part);
      for (int strip = 0; strip < strip_count(); ++strip) count += reaches(strip, window) ? 1 : 0;
    }
    return count;
  }

  /// Whether a strip may cover the centre of a cell of the window.
  [[nodiscard]] bool reaches(int strip, const CellWindow& window) const noexcept {
    if (reach_ == nullptr) return true;
    const Grid& grid = out_.grid;
    const int row = strip * step_px_;
    const ScanReach::Box& a = reach_->boxes[static_cast<std::size_t>(row / group_rows_)];
    const ScanReach::Box& b =
        reach_->boxes[static_cast<std::size_t>((row + step_px_) / group_rows_)];
    constexpr double kSnapped_px = 1e-3;  // half a subcell, and more
    const double slack_mm = kSnapped_px * grid.cell_mm + static_cast<double>(reach_->rounding_mm);
    const auto meets = [slack_mm](float low_mm, float high_mm, double begin_mm, double end_mm) {
      return static_cast<double>(high_mm) + slack_mm >= begin_mm &&
             static_cast<double>(low_mm) - slack_mm <= end_mm;
    };
    return meets(std::min(a.x_min_mm, b.x_min_mm), std::max(a.x_max_mm, b.x_max_mm),
                 grid.x_of(window.column_begin), grid.x_of(window.column_end - 1)) &&
           meets(std::min(a.y_min_mm, b.y_min_mm), std::max(a.y_max_mm, b.y_max_mm),
                 grid.y_of(window.row_begin), grid.y_of(window.row_end - 1));
  }

  void paint(const CellWindow& window, Scratch& s, const Budget& budget) const noexcept {
    for (int row = window.row_begin; row < window.row_end; row += kRowsPerLook) {
      if (budget.is_over()) return;
      clear(out_, {window.column_begin, window.column_end, row,
                   std::min(row + kRowsPerLook, window.row_end)});
    }
    int row_below = -1;
    for (int strip = 0; strip < strip_count() && !budget.is_over_at(strip); ++strip) {
      if (!reaches(strip, window)) continue;
      std::swap(s.above, s.below);
      if (row_below != strip) kernels_.transform_row(to_grid_, thin_, strip, s.above);
      row_below = strip + 1;
      kernels_.transform_row(to_grid_, thin_, row_below, s.below);
      paint_strip(strip, window, s);
    }
  }

  void paint_strip(int strip_index, const CellWindow& window, const Scratch& s) const noexcept {
    const QuadStrip strip{s.above.u.data(),
                          s.above.v.data(),
                          s.above.z_mm.data(),
                          s.below.u.data(),
                          s.below.v.data(),
                          s.below.z_mm.data(),
                          thin_.width_px - 1,
                          strip_index * step_px_ * scan_.width_px,
                          step_px_,
                          step_px_ * scan_.width_px};
    const MapCells cells(out_, window);
    QuadList several = s.list(0);
    QuadList rest = s.list(1);
    kernels_.paint_single_cells(strip, limits_, cells, several);
    kernels_.paint_several_cells(strip, cells, several, rest);
    for (int i = 0; i < rest.count; ++i)
      paint_triangles(strip, rest.quad[i], rest.edges[i], window, out_);
  }

  const RangeImageView& scan_;
  RangeImageView thin_;
  int step_px_;
  const ScanReach* reach_;
  int group_rows_;
  ScanToGrid to_grid_;
  EdgeLimits limits_;
  const RowKernels& kernels_;
  const HeightMap& out_;
};

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
  (void)take_scratches(arena, std::max(scan_width_px, 0));
  return arena.required_bytes();
}

Status paint(const RangeImageView& scan, const Pose& work_T_scan, const PaintConfig& config,
             Arena& scratch, const HeightMap& out, const Budget& budget) noexcept {
  if (const Status status = validate(config); status != Status::kOk) return status;
  if (const Status status = check_arguments(scan, work_T_scan, out); status != Status::kOk)
    return status;
  const ArenaScope scope(scratch);
  const Scratches scratches = take_scratches(scratch, thinned(scan, config.step_px).width_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  return Painter(scan, work_T_scan, config, out).run(scratches, budget);
}

}  // namespace flatpose::rectify
