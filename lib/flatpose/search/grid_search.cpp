#include "flatpose/search/grid_search.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/pyramid.hpp"
#include "flatpose/scene/scene.hpp"

namespace flatpose::search {
namespace {

// Slopes are binned so that the template is rotated once a bin. A bin's width of 0.1 is 5.7 degrees
// on the flat.
constexpr double kSlopeBin = 0.1;
constexpr int kSlopeBinReach = 24;
constexpr int kSlopeBinsAcross = 2 * kSlopeBinReach + 1;
constexpr int kBinCount = kSlopeBinsAcross * kSlopeBinsAcross;

// The best of each quarter of the angles is kept apart at every place, so that a part that is
// nearly symmetric does not lose its true angle to a neighbour's false one.
constexpr int kSectorCount = 4;

struct Best {
  std::int32_t cost;
  std::int32_t angle_index;
};

struct SearchMemory {
  std::span<Place> places;
  std::span<std::int32_t> place_bin;
  std::span<std::int32_t> order;          ///< Places by bin.
  std::span<std::int32_t> place_of_cell;  ///< -1: not planar.
  std::span<Best> best;                   ///< Of every place and sector.
  std::span<std::int32_t> bin_begin;
};

SearchMemory take_search_memory(Arena& arena, std::size_t cell_count) noexcept {
  return {arena.take<Place>(cell_count),
          arena.take<std::int32_t>(cell_count),
          arena.take<std::int32_t>(cell_count),
          arena.take<std::int32_t>(cell_count),
          arena.take<Best>(cell_count * kSectorCount),
          arena.take<std::int32_t>(kBinCount + 1)};
}

int slope_bin(double slope) noexcept {
  return static_cast<int>(std::floor(slope / kSlopeBin + 0.5));
}

int bin_index(double slope_x, double slope_y) noexcept {
  return (slope_bin(slope_y) + kSlopeBinReach) * kSlopeBinsAcross + slope_bin(slope_x) +
         kSlopeBinReach;
}

class Search {
 public:
  Search(const SearchImages& images, const TiltField& field, const model::Template& part,
         int anchor_index, const GridSearchConfig& config) noexcept
      : images_(images),
        field_(field),
        part_(part),
        anchor_(part.anchors[anchor_index]),
        anchor_index_(anchor_index),
        config_(config),
        scale_(score_scale(config.score)),
        angle_count_(angle_count(part.symmetry, config.angle_step_rad)) {}

  bool take_memory(Arena& scratch) noexcept {
    memory_ = take_search_memory(scratch, static_cast<std::size_t>(images_.grid.width_px) *
                                              static_cast<std::size_t>(images_.grid.height_px));
    return !scratch.failed();
  }

  /// The planarity gate: what is left are the hypotheses.
  void collect_places() noexcept {
    const double slope_limit = slope_of_max_tilt();
    place_count_ = 0;
    for (int y = 0; y < images_.grid.height_px; ++y) {
      for (int x = 0; x < images_.grid.width_px; ++x) {
        const bool on_grid = x % config_.stride_px == 0 && y % config_.stride_px == 0;
        const bool planar = on_grid && is_place(x, y, slope_limit);
        memory_.place_of_cell[cell_index(x, y)] = planar ? place_count_ : -1;
        if (planar) add_place(x, y);
      }
    }
    sort_by_bin();
  }

  void evaluate_all() noexcept {
    std::fill(memory_.best.begin(), memory_.best.end(), Best{0, -1});
    for (int bin = 0; bin < kBinCount; ++bin) {
      if (memory_.bin_begin[bin] == memory_.bin_begin[bin + 1]) continue;
      for (int angle = 0; angle < angle_count_; ++angle) evaluate_bin(bin, angle);
    }
  }

  /// Local minima among neighbours in place and angle, best first, at most as many as `candidates`
  /// holds.
  int pick(std::span<Candidate> candidates) noexcept {
    int count = 0;
    for (int p = 0; p < place_count_; ++p) {
      for (int sector = 0; sector < kSectorCount; ++sector) {
        const Best& best = memory_.best[p * kSectorCount + sector];
        if (best.angle_index < 0 || !is_local_minimum(memory_.places[p], best)) continue;
        insert({best.cost, best.angle_index, memory_.places[p].column, memory_.places[p].row,
                static_cast<std::int16_t>(anchor_index_), Pose{}},
               candidates, count);
      }
    }
    for (Candidate& c : candidates.first(static_cast<std::size_t>(count))) finish(c);
    return count;
  }

  [[nodiscard]] std::int64_t hypothesis_count() const noexcept {
    return static_cast<std::int64_t>(place_count_) * angle_count_;
  }

 private:
  [[nodiscard]] std::size_t cell_index(int x, int y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(images_.grid.width_px) +
           static_cast<std::size_t>(x);
  }

  [[nodiscard]] double slope_of_max_tilt() const noexcept {
    const auto [s, c] = sin_cos(config_.max_tilt_rad);
    return std::min(s / c, kSlopeBin * kSlopeBinReach);
  }

  [[nodiscard]] bool is_place(int x, int y, double slope_limit) const noexcept {
    if (!(field_.rms_mm(x, y) <= config_.planarity_mm)) return false;  // NaN at the border
    const double sx = field_.slope_x(x, y);
    const double sy = field_.slope_y(x, y);
    return sx * sx + sy * sy <= slope_limit * slope_limit;
  }

  void add_place(int x, int y) noexcept {
    const double sx = field_.slope_x(x, y);
    const double sy = field_.slope_y(x, y);
    const Vec3 normal = normalized({-sx, -sy, 1.0});
    const double unit_per_cell_q8 = images_.grid.cell_mm * kHeightUnitsPerMm * 256.0;
    const auto rounded = [](double v) { return static_cast<std::int32_t>(std::floor(v + 0.5)); };
    Place place;
    place.column = static_cast<std::int16_t>(x);
    place.row = static_cast<std::int16_t>(y);
    // Saturates as the heights that it is held against do, so that no difference overflows.
    place.height_unit =
        rounded(std::clamp((field_.plane_mm(x, y) - images_.base_mm) * kHeightUnitsPerMm,
                           -kHeightUnitMax, kHeightUnitMax));
    place.slope_x_q8 = rounded(sx * unit_per_cell_q8);
    place.slope_y_q8 = rounded(sy * unit_per_cell_q8);
    place.normal_x_unit = static_cast<std::int16_t>(rounded(normal.x * kNormalUnits));
    place.normal_y_unit = static_cast<std::int16_t>(rounded(normal.y * kNormalUnits));
    memory_.places[place_count_] = place;
    memory_.place_bin[place_count_] = bin_index(sx, sy);
    ++place_count_;
  }

  void sort_by_bin() noexcept {  // counting sort, stable
    std::fill(memory_.bin_begin.begin(), memory_.bin_begin.end(), 0);
    for (int p = 0; p < place_count_; ++p) ++memory_.bin_begin[memory_.place_bin[p] + 1];
    for (int bin = 0; bin < kBinCount; ++bin) memory_.bin_begin[bin + 1] += memory_.bin_begin[bin];
    for (int p = place_count_ - 1; p >= 0; --p)
      memory_.order[--memory_.bin_begin[memory_.place_bin[p] + 1]] = p;
    // Every begin now stands one bin too high: entry b + 1 is where bin b starts.
    for (int bin = 0; bin < kBinCount; ++bin) memory_.bin_begin[bin] = memory_.bin_begin[bin + 1];
    memory_.bin_begin[kBinCount] = place_count_;
  }

  void evaluate_bin(int bin, int angle) noexcept {
    const double slope_x = (bin % kSlopeBinsAcross - kSlopeBinReach) * kSlopeBin;
    const double slope_y = (bin / kSlopeBinsAcross - kSlopeBinReach) * kSlopeBin;
    const ProjectedTemplate projected = project(part_, anchor_, slope_x, slope_y, angle_rad(angle),
                                                images_.grid.cell_mm, config_.score);
    const auto cutoff =
        static_cast<std::int32_t>(cost_max(projected, scale_) * config_.cost_share_max);
    const int sector = angle * kSectorCount / angle_count_;
    for (int i = memory_.bin_begin[bin]; i < memory_.bin_begin[bin + 1]; ++i) {
      Best& best = memory_.best[memory_.order[i] * kSectorCount + sector];
      if (angle == 0 || (angle - 1) * kSectorCount / angle_count_ != sector) best = {cutoff, -1};
      const std::int32_t sum =
          cost(images_, projected, scale_, memory_.places[memory_.order[i]], best.cost);
      if (sum < best.cost) best = {sum, angle};
    }
  }

  [[nodiscard]] double angle_rad(int index) const noexcept {
    return angle_range_rad(part_.symmetry) * index / angle_count_;
  }

  [[nodiscard]] bool angles_are_close(int a, int b) const noexcept {
    const int apart = std::abs(a - b);
    return std::min(apart, angle_count_ - apart) <= 2;
  }

  /// Whether no neighbouring place is better at about the same angle (ties: the earlier place keeps
  /// it).
  [[nodiscard]] bool is_local_minimum(const Place& place, const Best& best) const noexcept {
    const int reach_px = 2 * config_.stride_px;
    for (int dy = -reach_px; dy <= reach_px; dy += config_.stride_px) {
      for (int dx = -reach_px; dx <= reach_px; dx += config_.stride_px) {
        const int x = place.column + dx;
        const int y = place.row + dy;
        if (!images_.missing.contains(x, y)) continue;
        const std::int32_t other = memory_.place_of_cell[cell_index(x, y)];
        if (other < 0) continue;
        for (int sector = 0; sector < kSectorCount; ++sector) {
          const Best& rival = memory_.best[other * kSectorCount + sector];
          if (rival.angle_index < 0 || !angles_are_close(rival.angle_index, best.angle_index))
            continue;
          if (rival.cost < best.cost) return false;
          const bool earlier = dy < 0 || (dy == 0 && dx < 0) ||
                               (dx == 0 && dy == 0 && rival.angle_index < best.angle_index);
          if (rival.cost == best.cost && earlier) return false;
        }
      }
    }
    return true;
  }

  static bool precedes(const Candidate& a, const Candidate& b) noexcept {
    if (a.cost_q10 != b.cost_q10) return a.cost_q10 < b.cost_q10;
    if (a.row != b.row) return a.row < b.row;
    if (a.column != b.column) return a.column < b.column;
    return a.angle_index < b.angle_index;
  }

  static void insert(const Candidate& candidate, std::span<Candidate> sorted, int& count) noexcept {
    const int capacity = static_cast<int>(sorted.size());
    if (count == capacity) {
      if (capacity == 0 || !precedes(candidate, sorted[count - 1])) return;
      --count;
    }
    int at = count++;
    for (; at > 0 && precedes(candidate, sorted[at - 1]); --at) sorted[at] = sorted[at - 1];
    sorted[at] = candidate;
  }

  /// The pose of a candidate, and its cost on a scale of its own tilt.
  void finish(Candidate& c) const noexcept {
    const double sx = field_.slope_x(c.column, c.row);
    const double sy = field_.slope_y(c.column, c.row);
    const Vec3 normal = normalized({-sx, -sy, 1.0});
    const Rotation rotation = tilt_rotation(normal) * rotation_about_z(angle_rad(c.angle_index));
    const Vec3 anchor_work_mm{images_.grid.x_of(c.column), images_.grid.y_of(c.row),
                              field_.plane_mm(c.column, c.row)};
    c.work_T_object = {rotation, anchor_work_mm - rotation * Vec3{anchor_.x_mm, anchor_.y_mm, 0.0}};
    const ProjectedTemplate projected = project(part_, anchor_, sx, sy, angle_rad(c.angle_index),
                                                images_.grid.cell_mm, config_.score);
    c.cost_q10 = c.cost_q10 * 1024 / std::max(1, cost_max(projected, scale_));
  }

  const SearchImages& images_;
  const TiltField& field_;
  const model::Template& part_;
  const model::Anchor& anchor_;
  int anchor_index_;
  const GridSearchConfig& config_;
  ScoreScale scale_;
  int angle_count_;
  int place_count_ = 0;
  SearchMemory memory_;
};

// Beyond a right angle the tangent turns negative and would bound no slope.
bool is_valid(const GridSearchConfig& config) noexcept {
  constexpr double kTiltEnd_rad = 1.57;
  return config.angle_step_rad > 0.0 && config.stride_px >= 1 && config.max_tilt_rad >= 0.0 &&
         config.max_tilt_rad <= kTiltEnd_rad && config.cost_share_max >= 0.0 &&
         config.cost_share_max <= 1.0;
}

}  // namespace

void reserve_search_scratch(Arena& arena, const rectify::Grid& fine) noexcept {
  const rectify::Grid coarse = image::halved(fine);
  const std::size_t cell_count =
      static_cast<std::size_t>(coarse.width_px) * static_cast<std::size_t>(coarse.height_px);
  const std::size_t fine_count =
      static_cast<std::size_t>(fine.width_px) * static_cast<std::size_t>(fine.height_px);
  {
    const ArenaScope scope(arena);  // build_search_images: a copy of the edges and eight masks
    (void)arena.take<image::EdgePoint>(fine_count / scene::kCellsPerEdge + 1);
    for (int k = 0; k < image::kOctantCount; ++k) (void)arena.take<std::uint8_t>(cell_count);
  }
  {
    const ArenaScope scope(arena);  // fit_tilt_field
    for (int k = 0; k < 3; ++k) (void)arena.take<double>(cell_count);
  }
  (void)take_search_memory(arena, cell_count);
}

double angle_range_rad(const model::Symmetry& symmetry) noexcept {
  return symmetry.order == model::kFullSymmetry ? 0.0 : 2.0 * kPi / symmetry.order;
}

int angle_count(const model::Symmetry& symmetry, double angle_step_rad) noexcept {
  const double range_rad = angle_range_rad(symmetry);
  const double count = std::ceil(range_rad / angle_step_rad);
  return std::clamp(static_cast<int>(std::min(count, 1.0 * kAngleCountMax)), 1, kAngleCountMax);
}

Result<GridSearchResult> grid_search(const SearchImages& images, const TiltField& field,
                                     const model::Template& part, int anchor_index,
                                     const GridSearchConfig& config, Arena& scratch,
                                     std::span<Candidate> candidates) noexcept {
  if (anchor_index < 0 || anchor_index >= part.anchor_count || !is_valid(config)) {
    return Status::kInvalidArgument;
  }
  if (!same_shape(images.missing, field.rms_mm)) return Status::kShapeMismatch;
  const ArenaScope scope(scratch);
  Search search(images, field, part, anchor_index, config);
  if (!search.take_memory(scratch)) return Status::kOutOfMemory;
  search.collect_places();
  search.evaluate_all();
  return GridSearchResult{search.pick(candidates), search.hypothesis_count()};
}

}  // namespace flatpose::search
