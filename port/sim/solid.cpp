#include "port/sim/solid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace flatpose::sim {
namespace {

constexpr double kCellMm = 2.0;
constexpr double kMarginMm = 1.0;
constexpr double kTinyMm = 1e-9;  // far above the rounding at 2 m, far below anything visible

int cell_index(double offset_mm, int count) {
  return std::clamp(static_cast<int>(std::floor(offset_mm / kCellMm)), 0, count - 1);
}

Vec2 plan(const Ray& ray, double distance_mm) {
  return {ray.origin_mm.x + distance_mm * ray.direction.x,
          ray.origin_mm.y + distance_mm * ray.direction.y};
}

/// Shortens [from, to] to where low <= start + t * step <= high.
void clip(double start, double step, double low, double high, double& from, double& to) {
  if (step == 0.0) {
    if (start < low || start > high) to = from - 1.0;
    return;
  }
  const double a = (low - start) / step;
  const double b = (high - start) / step;
  from = std::max(from, std::min(a, b));
  to = std::min(to, std::max(a, b));
}

}  // namespace

Solid::Solid(std::shared_ptr<const Part> part) : part_(std::move(part)) {
  Vec2 low{1e9, 1e9};
  Vec2 high{-1e9, -1e9};
  for (const Vec2 p : part_->outline.outer) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  low_mm_ = {low.x - kMarginMm, low.y - kMarginMm, -part_->thickness_mm - kMarginMm};
  high_mm_ = {high.x + kMarginMm, high.y + kMarginMm, height_max_mm(*part_) + kMarginMm};
  sphere_center_mm_ = 0.5 * (low_mm_ + high_mm_);
  sphere_radius_mm_ = 0.5 * norm(high_mm_ - low_mm_);
  int loop_index = 0;
  add_edges(part_->outline.outer, loop_index);
  for (const Loop& hole : part_->outline.holes) add_edges(hole, ++loop_index);
  for (const Area& area : part_->areas) add_edges(area.loop, ++loop_index);
  build_grid();
}

void Solid::add_edges(const Loop& loop, int loop_index) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    edges_.push_back({loop[i], loop[(i + 1) % loop.size()] - loop[i], loop_index});
  }
}

void Solid::build_grid() {
  columns_ = static_cast<int>(std::ceil((high_mm_.x - low_mm_.x) / kCellMm));
  rows_ = static_cast<int>(std::ceil((high_mm_.y - low_mm_.y) / kCellMm));
  for (int row = 0; row < rows_; ++row) {
    const TopRow middles(*part_, low_mm_.y + (row + 0.5) * kCellMm);
    for (int column = 0; column < columns_; ++column) {
      const double x_mm = low_mm_.x + (column + 0.5) * kCellMm;
      cells_.push_back(middles.height_mm(x_mm).value_or(kNoPart));
    }
  }
  row_edges_.resize(rows_);
  for (std::size_t i = 0; i < edges_.size(); ++i) mark(static_cast<int>(i));
}

int Solid::row_of(double y_mm) const noexcept { return cell_index(y_mm - low_mm_.y, rows_); }

void Solid::mark(int edge_index) {
  const Edge& edge = edges_[edge_index];
  const double y_low = std::min(edge.from.y, edge.from.y + edge.along.y) - kTinyMm;
  const double y_high = std::max(edge.from.y, edge.from.y + edge.along.y) + kTinyMm;
  const int last_row = row_of(y_high);
  for (int row = row_of(y_low); row <= last_row; ++row) {
    // The piece of the edge in this row of cells.
    double from = 0.0;
    double to = 1.0;
    const double row_mm = low_mm_.y + row * kCellMm;
    clip(edge.from.y, edge.along.y, row_mm - kTinyMm, row_mm + kCellMm + kTinyMm, from, to);
    if (from > to) continue;
    row_edges_[row].push_back(edge_index);
    const double a = edge.from.x + from * edge.along.x - low_mm_.x;
    const double b = edge.from.x + to * edge.along.x - low_mm_.x;
    const int last_column = cell_index(std::max(a, b) + kTinyMm, columns_);
    for (int column = cell_index(std::min(a, b) - kTinyMm, columns_); column <= last_column;
         ++column) {
      cells_[row * columns_ + column] = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

double Solid::height_at(Vec2 p) const noexcept {
  const int row = row_of(p.y);
  const double stored_mm = cells_[row * columns_ + cell_index(p.x - low_mm_.x, columns_)];
  if (!std::isnan(stored_mm)) return stored_mm;
  // The even-odd rule for all loops at once: a bit a loop, turned over by each of its edges that
  // lies to the right of p. Only edges of p's own row can.
  std::uint64_t inside = 0;
  for (const int index : row_edges_[row]) {
    const Edge& edge = edges_[index];
    const double end_y = edge.from.y + edge.along.y;
    if ((edge.from.y > p.y) == (end_y > p.y)) continue;
    const double x = edge.from.x + edge.along.x * (p.y - edge.from.y) / edge.along.y;
    if (p.x < x) inside ^= std::uint64_t{1} << edge.loop;
  }
  const int hole_count = static_cast<int>(part_->outline.holes.size());
  const std::uint64_t holes = ((std::uint64_t{1} << hole_count) - 1) << 1;
  if ((inside & 1) == 0 || (inside & holes) != 0) return kNoPart;
  const std::uint64_t areas = inside >> (1 + hole_count);
  return areas == 0 ? 0.0 : part_->areas[std::bit_width(areas) - 1].height_mm;
}

std::optional<Solid::Interval> Solid::clip_to_box(const Ray& ray, Interval range) const noexcept {
  const Vec3& o = ray.origin_mm;
  const Vec3& d = ray.direction;
  clip(o.z, d.z, low_mm_.z, high_mm_.z, range.from_mm, range.to_mm);
  clip(o.x, d.x, low_mm_.x, high_mm_.x, range.from_mm, range.to_mm);
  clip(o.y, d.y, low_mm_.y, high_mm_.y, range.from_mm, range.to_mm);
  if (range.from_mm > range.to_mm) return std::nullopt;
  return range;
}

std::optional<double> Solid::height_without_edges(const Ray& ray, Interval range) const noexcept {
  const Vec2 a = plan(ray, range.from_mm);
  const Vec2 b = plan(ray, range.to_mm);
  const int left = cell_index(std::min(a.x, b.x) - low_mm_.x, columns_);
  const int right = cell_index(std::max(a.x, b.x) - low_mm_.x, columns_);
  const int bottom = cell_index(std::min(a.y, b.y) - low_mm_.y, rows_);
  const int top = cell_index(std::max(a.y, b.y) - low_mm_.y, rows_);
  const double height_mm = cells_[bottom * columns_ + left];
  for (int row = bottom; row <= top; ++row) {
    for (int column = left; column <= right; ++column) {
      // NaN, an edge, equals nothing.
      if (!(cells_[row * columns_ + column] == height_mm)) return std::nullopt;
    }
  }
  return height_mm;
}

std::optional<SolidHit> Solid::enter(const Ray& ray, Interval range, double height_mm,
                                     const Edge* edge) const noexcept {
  if (height_mm == kNoPart) return std::nullopt;
  Interval inside = range;
  clip(ray.origin_mm.z, ray.direction.z, -part_->thickness_mm, height_mm, inside.from_mm,
       inside.to_mm);
  if (inside.from_mm > inside.to_mm) return std::nullopt;
  if (inside.from_mm > range.from_mm) {
    const bool down = ray.direction.z < 0.0;
    return SolidHit{inside.from_mm, {0, 0, down ? 1.0 : -1.0}, down ? Face::kTop : Face::kBottom};
  }
  if (edge == nullptr) return SolidHit{inside.from_mm, -ray.direction, Face::kInside};
  Vec3 normal = normalized(Vec3{edge->along.y, -edge->along.x, 0.0});
  if (dot(normal, ray.direction) > 0.0) normal = -normal;
  return SolidHit{inside.from_mm, normal, Face::kSide};
}

void Solid::add_cut(const Edge& edge, const Ray& ray, Interval range, std::vector<Cut>& cuts) {
  const Vec2 d{ray.direction.x, ray.direction.y};
  const double turn = cross(d, edge.along);
  if (turn == 0.0) return;  // runs along the edge: the neighbours cut it
  const Vec2 to_edge = edge.from - Vec2{ray.origin_mm.x, ray.origin_mm.y};
  const double share = cross(to_edge, d) / turn;
  // A cut too many does no harm (the height is looked up on both sides of it), one too few would.
  if (!(share >= -kTinyMm && share <= 1.0 + kTinyMm)) return;
  const double distance_mm = cross(to_edge, edge.along) / turn;
  if (distance_mm > range.from_mm && distance_mm < range.to_mm) {
    cuts.push_back({distance_mm, &edge});
  }
}

void Solid::find_cuts(const Ray& ray, Interval range, std::vector<Cut>& cuts) const {
  cuts.clear();
  const double y_from = plan(ray, range.from_mm).y;
  const double y_to = plan(ray, range.to_mm).y;
  const int last_row = row_of(std::max(y_from, y_to));
  for (int row = row_of(std::min(y_from, y_to)); row <= last_row; ++row) {
    for (const int index : row_edges_[row]) add_cut(edges_[index], ray, range, cuts);
  }
  std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) {
    return a.distance_mm < b.distance_mm || (a.distance_mm == b.distance_mm && a.edge < b.edge);
  });
  cuts.push_back({range.to_mm, nullptr});
}

std::optional<SolidHit> Solid::first_hit(const Ray& ray, double from_mm, double to_mm) const {
  const auto range = clip_to_box(ray, {from_mm, to_mm});
  if (!range) return std::nullopt;
  if (const auto height_mm = height_without_edges(ray, *range)) {
    return enter(ray, *range, *height_mm, nullptr);
  }
  thread_local std::vector<Cut> cuts;  // kept: a heap call a ray would cost more than the ray
  find_cuts(ray, *range, cuts);
  Interval piece{range->from_mm, 0.0};
  const Edge* entered_over = nullptr;
  for (const Cut& cut : cuts) {
    piece.to_mm = cut.distance_mm;
    if (piece.to_mm - piece.from_mm > kTinyMm) {
      const double height_mm = height_at(plan(ray, 0.5 * (piece.from_mm + piece.to_mm)));
      if (const auto hit = enter(ray, piece, height_mm, entered_over)) return hit;
      piece.from_mm = cut.distance_mm;
    }
    entered_over = cut.edge;
  }
  return std::nullopt;
}

}  // namespace flatpose::sim
