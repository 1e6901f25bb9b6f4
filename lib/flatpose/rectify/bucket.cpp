#include "flatpose/rectify/bucket.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "flatpose/rectify/row_kernels.hpp"

namespace flatpose::rectify {
namespace {

constexpr std::int32_t kOutside = -1;

struct Entry {
  float z_mm;
  std::int32_t source_index;

  friend bool operator<(const Entry& a, const Entry& b) noexcept {
    return a.z_mm < b.z_mm || (a.z_mm == b.z_mm && a.source_index < b.source_index);
  }
};

struct Buffers {
  ScanRow row;
  std::span<std::int32_t> cell;   // of each scan pixel, or kOutside
  std::span<Entry> entries;       // by cell
  std::span<std::int32_t> begin;  // of a cell's entries; one more than there are cells

  Buffers(Arena& arena, int width_px, int height_px, const Grid& grid) noexcept
      : row(ScanRow::take(arena, width_px)) {
    const auto points = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
    cell = arena.take<std::int32_t>(points);
    entries = arena.take<Entry>(points);
    begin = arena.take<std::int32_t>(
        static_cast<std::size_t>(grid.width_px) * static_cast<std::size_t>(grid.height_px) + 1);
  }
};

std::int32_t cell_index(const ScanRow& row, int c, const Grid& grid) noexcept {
  const std::int32_t x = cell_of(row.u[c]);
  const std::int32_t y = cell_of(row.v[c]);
  const bool inside = x >= 0 && y >= 0 && x < grid.width_px && y < grid.height_px;
  return inside && !std::isnan(row.z_mm[c]) ? y * grid.width_px + x : kOutside;
}

/// Finds each pixel's cell and lets begin[cell + 1] count them, then sum up.
void count_cells(const RangeImageView& scan, const ScanToGrid& to_grid, const Grid& grid,
                 const Buffers& b, const Budget& budget) noexcept {
  std::fill(b.begin.begin(), b.begin.end(), 0);
  for (int r = 0; r < scan.height_px && !budget.is_over_at(r); ++r) {
    kPortableRowKernels.transform_row(to_grid, scan, r, b.row);
    std::int32_t* const cells = b.cell.data() + static_cast<std::ptrdiff_t>(r) * scan.width_px;
    for (int c = 0; c < scan.width_px; ++c) {
      cells[c] = cell_index(b.row, c, grid);
      if (cells[c] != kOutside) ++b.begin[cells[c] + 1];
    }
  }
  for (std::size_t i = 1; i < b.begin.size(); ++i) b.begin[i] += b.begin[i - 1];
}

/// Puts each point with its cell. begin[cell] moves to the cell's end, the next one's begin.
void scatter(const RangeImageView& scan, const ScanToGrid& to_grid, const Buffers& b,
             const Budget& budget) noexcept {
  std::int32_t source = 0;
  for (int r = 0; r < scan.height_px && !budget.is_over_at(r); ++r) {
    kPortableRowKernels.transform_row(to_grid, scan, r,
                                      b.row);  // cheaper again than keeping every height
    for (int c = 0; c < scan.width_px; ++c, ++source) {
      const std::int32_t cell = b.cell[source];
      if (cell != kOutside) b.entries[b.begin[cell]++] = {b.row.z_mm[c], source};
    }
  }
}

void write_medians(const Buffers& b, const HeightMap& out, const Budget& budget) noexcept {
  std::int32_t begin = 0;
  std::int32_t cell = 0;
  for (int y = 0; y < out.grid.height_px && !budget.is_over_at(y); ++y) {
    for (int x = 0; x < out.grid.width_px; ++x, ++cell) {
      const std::int32_t end = b.begin[cell];
      if (end > begin) {
        Entry* const first = b.entries.data() + begin;
        Entry* const median = first + (end - begin - 1) / 2;
        std::nth_element(first, median, first + (end - begin));
        out.height_mm.row(y)[x] = median->z_mm;
        out.source_index.row(y)[x] = median->source_index;
      }
      begin = end;
    }
  }
}

}  // namespace

std::size_t bucket_required_bytes(int scan_width_px, int scan_height_px,
                                  const Grid& grid) noexcept {
  Arena arena = Arena::measuring();
  (void)Buffers(arena, std::max(scan_width_px, 0), std::max(scan_height_px, 0), grid);
  return arena.required_bytes();
}

Status bucket(const RangeImageView& scan, const Pose& work_T_scan, Arena& scratch,
              const HeightMap& out, const Budget& budget) noexcept {
  if (const Status status = check_arguments(scan, work_T_scan, out); status != Status::kOk)
    return status;
  const ArenaScope scope(scratch);
  const Buffers buffers(scratch, scan.width_px, scan.height_px, out.grid);
  if (scratch.failed()) return Status::kOutOfMemory;
  clear(out);
  const ScanToGrid to_grid(work_T_scan, out.grid);
  count_cells(scan, to_grid, out.grid, buffers, budget);
  if (budget.was_over()) return Status::kStopped;
  scatter(scan, to_grid, buffers, budget);
  if (budget.was_over()) return Status::kStopped;
  write_medians(buffers, out, budget);
  return budget.was_over() ? Status::kStopped : Status::kOk;
}

}  // namespace flatpose::rectify
