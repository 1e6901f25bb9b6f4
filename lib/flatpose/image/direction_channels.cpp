#include "flatpose/image/direction_channels.hpp"

#include <algorithm>
#include <cstring>

namespace flatpose::image {
namespace {

constexpr int kStraight_third_px = 3;
constexpr int kDiagonal_third_px = 4;
static_assert(kOctantDistanceMax_third_px + kDiagonal_third_px <= 255, "sums must not wrap");

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
    if (cosine >= cos_half_width) cell.of[k] = 0;
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

/// The eight distances of a cell as one number of eight lanes.
using Octets = std::uint8_t __attribute__((vector_size(kOctantCount)));

inline Octets load(const OctantCell* cell) noexcept {
  Octets octets;
  std::memcpy(&octets, cell, sizeof octets);
  return octets;
}
inline void store(const Octets& octets, OctantCell* cell) noexcept {
  std::memcpy(cell, &octets, sizeof octets);
}
inline Octets smaller(const Octets& a, const Octets& b) noexcept { return a < b ? a : b; }

/// Shortens the distances of a row by way of the finished row before it and of the cell before,
/// which for kStep 1 is the left one and for -1 the right one.
template <int kStep>
void shorten_row(const OctantCell* previous, int width_px, OctantCell* row) noexcept {
  const OctantCell* from = kStep > 0 ? previous : previous + (width_px - 1);
  OctantCell* to = kStep > 0 ? row : row + (width_px - 1);
  Octets here = load(from);
  Octets behind = here;
  Octets carried = load(to);
  for (int i = 0; i < width_px; ++i, to += kStep) {
    if (i + 1 < width_px) from += kStep;
    const Octets ahead = load(from);
    const Octets diagonal = smaller(behind, ahead) + kDiagonal_third_px;
    const Octets above = smaller(diagonal, here + kStraight_third_px);
    carried = smaller(smaller(above, load(to)), carried + kStraight_third_px);
    store(carried, to);
    behind = here;
    here = ahead;
  }
}

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
                      const OctantImage& distance_third_px) noexcept {
  if (!is_valid(config) || !goes_by_rows(edges)) return Status::kInvalidArgument;
  const ImageView<OctantCell>& cells = distance_third_px.cells;
  if (cells.empty()) return Status::kOk;
  const int w = cells.width_px;
  const int last = cells.height_px - 1;
  OctantCell far;
  far.of.fill(config.distance_max_third_px);
  Pen pen(edges, config);
  // A row without one before it is its own: four to the next cell and three to itself shorten
  // nothing that three to the next would not.
  for (int y = 0; y <= last; ++y) {
    std::fill_n(cells.row(y), w, far);
    pen.draw_row(y, w, cells.row(y));
    shorten_row<1>(cells.row(y > 0 ? y - 1 : y), w, cells.row(y));
  }
  for (int y = last; y >= 0; --y) shorten_row<-1>(cells.row(y < last ? y + 1 : y), w, cells.row(y));
  return Status::kOk;
}

}  // namespace flatpose::image
