#include "flatpose/image/direction_channels.hpp"

#include <algorithm>
#include <cstring>

#include "flatpose/image/row_kernels.hpp"

namespace flatpose::image {
namespace {

struct Direction {
  float x;
  float y;
};
constexpr float kDiagonal = 0.70710678F;
constexpr std::array<Direction, kOctantCount> kOctantCentre = {{{1.0F, 0.0F},
                                                                {kDiagonal, kDiagonal},
                                                                {0.0F, 1.0F},
                                                                {-kDiagonal, kDiagonal},
                                                                {-1.0F, 0.0F},
                                                                {-kDiagonal, -kDiagonal},
                                                                {0.0F, -1.0F},
                                                                {kDiagonal, -kDiagonal}}};

void draw(const EdgePoint& edge, float cos_half_width, OctantCell& cell) noexcept {
  for (std::size_t k = 0; k < kOctantCount; ++k) {
    const float cosine = edge.dx * kOctantCentre[k].x + edge.dy * kOctantCentre[k].y;
    cell.of[k] = cosine >= cos_half_width ? std::uint8_t{0} : cell.of[k];
  }
  // Rounding must not lose an edge that lies between two octants.
  cell.of[static_cast<std::size_t>(octant_of(edge.dx, edge.dy))] = 0;
}

/// Draws the edges row by row; each row is asked for once, from above to below.
class Pen {
 public:
  Pen(std::span<const EdgePoint> edges, const ChannelConfig& config) noexcept
      : edges_(edges),
        config_(config),
        cos_half_width_(static_cast<float>(sin_cos(config.half_width_rad).cos)) {}

  void draw_row(int y, int width_px, OctantCell* row) noexcept {
    for (; next_ < edges_.size() && cell_of(edges_[next_].row) <= y; ++next_) {
      const EdgePoint& edge = edges_[next_];
      const int x = cell_of(edge.column);
      if (edge.row < 0 || edge.column < 0 || x >= width_px) continue;
      if (edge.kind == EdgeKind::kNone) continue;
      if (edge.kind == EdgeKind::kCrease && !config_.with_creases) continue;
      draw(edge, cos_half_width_, row[x]);
    }
  }

 private:
  [[nodiscard]] int cell_of(int edge_cell) const noexcept { return edge_cell / config_.edge_cells; }

  std::span<const EdgePoint> edges_;
  const ChannelConfig& config_;
  float cos_half_width_;
  std::size_t next_ = 0;
};

bool is_valid(const ChannelConfig& config) noexcept {
  constexpr double kRounding = 1e-9;
  return config.half_width_rad >= kPi / kOctantCount - kRounding && config.half_width_rad <= kPi &&
         config.edge_cells >= 1 && config.distance_max_third_px >= 1 &&
         config.distance_max_third_px <= kOctantDistanceMax_third_px;
}

bool goes_by_rows(std::span<const EdgePoint> edges) noexcept {
  return std::is_sorted(edges.begin(), edges.end(),
                        [](const EdgePoint& a, const EdgePoint& b) { return a.row < b.row; });
}

}  // namespace

Status edge_distances(std::span<const EdgePoint> edges, const ChannelConfig& config,
                      const OctantImage& distance_third_px, VectorPath path,
                      const Budget& budget) noexcept {
  if (!is_valid(config) || !goes_by_rows(edges)) return Status::kInvalidArgument;
  const ImageView<OctantCell>& cells = distance_third_px.cells;
  if (cells.empty()) return Status::kOk;
  const int w = cells.width_px;
  const int last = cells.height_px - 1;
  Pen pen(edges, config);
  const RowKernels& kernels = row_kernels(path);
  // A row without one before it is its own: four to the next cell and three to itself shorten
  // nothing that three to the next would not.
  for (int y = 0; y <= last && !budget.is_over_at(y); ++y) {
    std::memset(cells.row(y), config.distance_max_third_px,
                sizeof(OctantCell) * static_cast<std::size_t>(w));
    pen.draw_row(y, w, cells.row(y));
    kernels.shorten_forward(cells.row(y > 0 ? y - 1 : y), w, cells.row(y));
  }
  for (int y = last; y >= 0 && !budget.is_over_at(y); --y)
    kernels.shorten_backward(cells.row(y < last ? y + 1 : y), w, cells.row(y));
  return budget.was_over() ? Status::kStopped : Status::kOk;
}

}  // namespace flatpose::image
