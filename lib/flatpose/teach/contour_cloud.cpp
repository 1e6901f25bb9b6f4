#include <algorithm>
#include <cmath>

#include "flatpose/teach/clouds.hpp"
#include "flatpose/teach/spread_order.hpp"

namespace flatpose::teach {
namespace {

constexpr int kContourCountMin = 8;
// A contour's piece shorter than this many cells, or than this share of the part, is a stray edge.
constexpr int kChainCellsMin = 8;
constexpr double kChainShareMin = 0.04;
// Edges around a corner disagree about their direction; where the mean of unit directions is
// shorter than this, the point holds no direction well and is left out.
constexpr float kCoherenceMin = 0.86F;
constexpr int kSmoothReach_px = 3;

class ContourBuilder {
 public:
  ContourBuilder(const scene::Scene& scene, const PartMask& mask, Arena& arena) noexcept
      : scene_(scene), mask_(mask) {
    const rectify::Grid& grid = scene.map.grid;
    edge_at_ = arena.take_image<std::int32_t>(grid.width_px, grid.height_px);
    chain_ = arena.take<std::int32_t>(scene.edges.size());
    candidates_ = arena.take<std::int32_t>(scene.edges.size());
    directions_ = arena.take<Direction>(scene.edges.size());
    nearest_ = arena.take<double>(scene.edges.size());
    order_ = arena.take<int>(model::kContourPointCountMax);
  }

  void collect() noexcept {
    for (int y = 0; y < edge_at_.height_px; ++y)
      std::fill_n(edge_at_.row(y), edge_at_.width_px, -1);
    for (std::size_t i = 0; i < scene_.edges.size(); ++i) {
      const image::EdgePoint& e = scene_.edges[i];
      if (mask_.is_contour(e.column, e.row) != 0)
        edge_at_(e.column, e.row) = static_cast<std::int32_t>(i);
    }
    drop_short_chains();
    for (std::size_t i = 0; i < scene_.edges.size(); ++i) {
      const image::EdgePoint& e = scene_.edges[i];
      if (edge_at_(e.column, e.row) != static_cast<std::int32_t>(i)) continue;
      Direction direction;
      if (!smooth_direction(e, &direction)) continue;
      directions_[candidate_count_] = direction;
      candidates_[candidate_count_++] = static_cast<std::int32_t>(i);
    }
  }

  Status write(const Pose& work_T_object, model::Template& part) noexcept {
    if (candidate_count_ < kContourCountMin) return Status::kNoContour;
    const double turn_mm = 6.0 * scene_.map.grid.cell_mm;  // what opposite directions count as
    const double cell_mm = scene_.map.grid.cell_mm;
    const auto distance = [&](int a, int b) {
      const image::EdgePoint& p = scene_.edges[candidates_[a]];
      const image::EdgePoint& q = scene_.edges[candidates_[b]];
      const double dx = static_cast<double>(p.x_px - q.x_px) * cell_mm;
      const double dy = static_cast<double>(p.y_px - q.y_px) * cell_mm;
      const double turn_x =
          static_cast<double>(directions_[a].x - directions_[b].x) * 0.5 * turn_mm;
      const double turn_y =
          static_cast<double>(directions_[a].y - directions_[b].y) * 0.5 * turn_mm;
      return dx * dx + dy * dy + turn_x * turn_x + turn_y * turn_y;
    };
    part.contour_count = spread_order(candidate_count_, 0, distance, nearest_, order_);
    const Pose object_T_work = work_T_object.inverse();
    for (int k = 0; k < part.contour_count; ++k) {
      part.contour[k] =
          to_point(scene_.edges[candidates_[order_[k]]], directions_[order_[k]], object_T_work);
    }
    return Status::kOk;
  }

 private:
  struct Direction {
    float x;
    float y;
  };

  // Eight-connected chains of contour cells; the short ones are taken out of edge_at_.
  void drop_short_chains() noexcept {
    for (std::size_t i = 0; i < scene_.edges.size(); ++i) chain_[i] = 0;
    for (std::size_t i = 0; i < scene_.edges.size(); ++i) {
      const image::EdgePoint& e = scene_.edges[i];
      if (edge_at_(e.column, e.row) != static_cast<std::int32_t>(i) || chain_[i] != 0) continue;
      const int length = follow(static_cast<std::int32_t>(i));
      if (length >= chain_cells_min()) continue;
      for (int k = 0; k < length; ++k) {
        const image::EdgePoint& dropped = scene_.edges[candidates_[k]];
        edge_at_(dropped.column, dropped.row) = -1;
      }
    }
  }

  [[nodiscard]] int chain_cells_min() const noexcept {
    return std::max(kChainCellsMin,
                    static_cast<int>(kChainShareMin * std::sqrt(1.0 * mask_.cell_count)));
  }

  // Lists the chain that starts at an edge in candidates_, breadth first.
  int follow(std::int32_t start) noexcept {
    int count = 0;
    candidates_[count++] = start;
    chain_[start] = 1;
    for (int k = 0; k < count; ++k) {
      const image::EdgePoint& e = scene_.edges[candidates_[k]];
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (!edge_at_.contains(e.column + dx, e.row + dy)) continue;
          const std::int32_t next = edge_at_(e.column + dx, e.row + dy);
          if (next < 0 || chain_[next] != 0) continue;
          chain_[next] = 1;
          candidates_[count++] = next;
        }
      }
    }
    return count;
  }

  [[nodiscard]] bool smooth_direction(const image::EdgePoint& e,
                                      Direction* direction) const noexcept {
    float sum_x = 0.0F;
    float sum_y = 0.0F;
    float count = 0.0F;
    for (int dy = -kSmoothReach_px; dy <= kSmoothReach_px; ++dy) {
      for (int dx = -kSmoothReach_px; dx <= kSmoothReach_px; ++dx) {
        if (!edge_at_.contains(e.column + dx, e.row + dy)) continue;
        const std::int32_t other = edge_at_(e.column + dx, e.row + dy);
        if (other < 0) continue;
        const image::EdgePoint& o = scene_.edges[other];
        if (o.dx * e.dx + o.dy * e.dy < 0.0F) continue;  // the other side of a thin wall
        sum_x += o.dx;
        sum_y += o.dy;
        count += 1.0F;
      }
    }
    const float length = std::sqrt(sum_x * sum_x + sum_y * sum_y);
    if (length < kCoherenceMin * count) return false;
    *direction = {sum_x / length, sum_y / length};
    return true;
  }

  // The contour's height is that of the upper side a little inside of it.
  [[nodiscard]] model::ContourPoint to_point(const image::EdgePoint& e, Direction d,
                                             const Pose& object_T_work) const noexcept {
    const rectify::Grid& grid = scene_.map.grid;
    constexpr float kInside_px = 2.5F;
    const int column =
        std::clamp(static_cast<int>(e.x_px - kInside_px * d.x + 0.5F), 0, grid.width_px - 1);
    const int row =
        std::clamp(static_cast<int>(e.y_px - kInside_px * d.y + 0.5F), 0, grid.height_px - 1);
    // From there to the edge the surface goes on along the part's plane, whose normal is object z.
    const auto& m = object_T_work.rotation.m;
    const double slope = -(m[6] * d.x + m[7] * d.y) / m[8];
    const double z_mm = static_cast<double>(scene_.filled_mm(column, row)) +
                        slope * static_cast<double>(kInside_px) * grid.cell_mm;
    const Vec3 p = object_T_work * Vec3{grid.x_of(e.x_px), grid.y_of(e.y_px), z_mm};
    const Vec3 n = object_T_work.rotation * Vec3{d.x, d.y, 0.0};
    const double length = std::sqrt(n.x * n.x + n.y * n.y);
    return {static_cast<float>(p.x),          static_cast<float>(p.y),
            static_cast<float>(p.z),          static_cast<float>(n.x / length),
            static_cast<float>(n.y / length), e.step_mm};
  }

  const scene::Scene& scene_;
  const PartMask& mask_;
  ImageView<std::int32_t> edge_at_;  ///< Index of the contour's edge at a cell, or -1.
  std::span<std::int32_t> chain_;
  std::span<std::int32_t> candidates_;
  std::span<Direction> directions_;
  std::span<double> nearest_;
  std::span<int> order_;
  int candidate_count_ = 0;
};

}  // namespace

Status build_contour_cloud(const scene::Scene& scene, const PartMask& mask,
                           const Pose& work_T_object, Arena& scratch,
                           model::Template& part) noexcept {
  const ArenaScope scope(scratch);
  ContourBuilder builder(scene, mask, scratch);
  if (scratch.failed()) return Status::kOutOfMemory;
  builder.collect();
  return builder.write(work_T_object, part);
}

}  // namespace flatpose::teach
