#include "flatpose/search/grid_search.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/pyramid.hpp"
#include "flatpose/search/projector.hpp"

namespace flatpose::search {
namespace {

static_assert(kAngleCountMax / kSectorCount < kNoAngle);

/// Where the results of the blocks lie: by sector, as the places are. What is no place has no
/// angle.
struct SearchMemory {
  std::array<std::span<std::uint8_t>, kSectorCount> best_cost;
  std::array<std::span<std::uint8_t>, kSectorCount> best_angle;
  std::span<ShiftedTemplate> angles;
  std::span<Rotation> turns;  // by angle
};

SearchMemory take_search_memory(Arena& arena, std::size_t place_count) noexcept {
  SearchMemory memory;
  for (auto& cost : memory.best_cost) cost = arena.take<std::uint8_t>(place_count);
  for (auto& angle : memory.best_angle) angle = arena.take<std::uint8_t>(place_count);
  memory.angles = arena.take<ShiftedTemplate>(kAngleCountMax);
  memory.turns = arena.take<Rotation>(kAngleCountMax);
  return memory;
}

class Search {
 public:
  Search(const SearchImages& images, const TiltField& field, const Places& places,
         const model::Template& part, int anchor_index, const GridSearchConfig& config) noexcept
      : images_(images),
        field_(field),
        places_(places),
        part_(part),
        anchor_(part.anchors[anchor_index]),
        anchor_index_(anchor_index),
        config_(config),
        angle_range_rad_(angle_range_rad(part.symmetry, anchor_)),
        angle_count_(angle_count(angle_range_rad_, config.angle_step_rad)),
        projector_(part, anchor_, images, config.score, !images.config.use_height),
        offsets_(images.lattice) {}

  bool take_memory(Arena& scratch) noexcept {
    memory_ = take_search_memory(scratch, places_.index(0, places_.height));
    if (scratch.failed()) return false;
    for (const auto& cost : memory_.best_cost) std::fill(cost.begin(), cost.end(), kCostMax);
    for (const auto& angle : memory_.best_angle) std::fill(angle.begin(), angle.end(), kNoAngle);
    for (int angle = 0; angle < angle_count_; ++angle)
      memory_.turns[angle] = rotation_about_z(angle_rad(angle));
    return true;
  }

  void evaluate_all() noexcept {
    for (int bin = 0; bin < kBinCount; ++bin) {
      const int begin = places_.bin_begin[bin];
      const int end = places_.bin_begin[bin + 1];
      if (begin == end) continue;
      const std::uint8_t cutoff = turn_template(bin);
      for (int i = begin; i < end; ++i) evaluate(places_.blocks[i], cutoff);
    }
  }

  /// Local minima among neighbours in place and angle, best first, at most as many as `candidates`
  /// holds.
  int pick(std::span<Candidate> candidates) noexcept {
    int count = 0;
    for (int row = 0; row < places_.height; ++row) {
      for (int column = 0; column < places_.padded_width; column += kBlockSize) {
        if (lowest_cost(column, row) < room_below(candidates, count))
          pick_of_block(column, row, candidates, count);
      }
    }
    for (Candidate& c : candidates.first(static_cast<std::size_t>(count))) finish(c);
    return count;
  }

  [[nodiscard]] std::int64_t hypothesis_count() const noexcept {
    return places_.place_count * angle_count_;
  }

 private:
  struct Best {
    std::int32_t cost;
    std::int32_t angle_index;  // -1: none below the cut-off
  };

  [[nodiscard]] std::int16_t cell_of(int place) const noexcept {
    return static_cast<std::int16_t>(place * images_.lattice.stride_px);
  }

  // The template at all angles on the bin's plane; returns the cost below which hypotheses count.
  std::uint8_t turn_template(int bin) noexcept {
    const Tilt tilt = tilt_of(slope_x_of_bin(bin), slope_y_of_bin(bin));
    std::int32_t worst = 0;
    for (int angle = 0; angle < angle_count_; ++angle) {
      const ProjectedTemplate projected = projector_.at(tilt, memory_.turns[angle]);
      shift(projected, images_, offsets_, memory_.angles[angle]);
      worst = std::max(worst, cost_max(images_, projected));
    }
    rises_ = rise_range(memory_.angles.first(static_cast<std::size_t>(angle_count_)));
    return static_cast<std::uint8_t>(
        std::min(static_cast<std::int32_t>(worst * config_.cost_share_max), kCostMax));
  }

  void evaluate(const PlaceBlock& block, std::uint8_t cutoff) noexcept {
    const std::size_t first = places_.index(block.column, block.row);
    BlockJob job;
    job.image_bytes = images_.bytes.data() + images_.lattice.byte_of(block.column, block.row);
    job.place_unit = places_.height_unit.data() + first;
    job.bin = places_.bin.data() + first;
    job.wanted_bin = block.bin;
    job.angles = memory_.angles.first(static_cast<std::size_t>(angle_count_));
    job.rises = rises_;
    job.use_height = images_.config.use_height;
    job.surface_cap = static_cast<std::uint8_t>(images_.surface_cap);
    job.surface_weight = static_cast<std::uint8_t>(images_.surface_weight);
    job.cutoff = cutoff;
    for (int sector = 0; sector < kSectorCount; ++sector) {
      job.best_cost[sector] = memory_.best_cost[sector].data() + first;
      job.best_angle[sector] = memory_.best_angle[sector].data() + first;
    }
    search_block_for(config_.vector_path)(job);
  }

  [[nodiscard]] std::int32_t lowest_cost(int first_column, int row) const noexcept {
    const std::size_t first = places_.index(first_column, row);
    std::array<std::uint8_t, kBlockSize> lowest;
    lowest.fill(kCostMax);
    for (const auto& cost : memory_.best_cost) {
      const std::uint8_t* of_block = cost.data() + first;
      for (int i = 0; i < kBlockSize; ++i) lowest[i] = std::min(lowest[i], of_block[i]);
    }
    return *std::min_element(lowest.begin(), lowest.end());
  }

  // Few places are cheap enough to be compared with their neighbours.
  void pick_of_block(int first_column, int row, std::span<Candidate> candidates,
                     int& count) const noexcept {
    for (int column = first_column; column < first_column + kBlockSize; ++column) {
      for (int sector = 0; sector < kSectorCount; ++sector) {
        const Best best = best_at(column, row, sector);
        if (best.angle_index < 0 || best.cost >= room_below(candidates, count) ||
            !is_local_minimum(column, row, best))
          continue;
        insert({best.cost, best.angle_index, cell_of(column), cell_of(row),
                static_cast<std::int16_t>(anchor_index_), Pose{}},
               candidates, count);
      }
    }
  }

  [[nodiscard]] Best best_at(int column, int row, int sector) const noexcept {
    const std::size_t i = places_.index(column, row);
    const std::uint8_t angle = memory_.best_angle[sector][i];
    if (angle == kNoAngle) return {kCostMax, -1};
    return {memory_.best_cost[sector][i], sector_begin(sector, angle_count_) + angle};
  }

  [[nodiscard]] double angle_rad(int index) const noexcept {
    return angle_range_rad_ * index / angle_count_;
  }

  [[nodiscard]] bool angles_are_close(int a, int b) const noexcept {
    const int apart = std::abs(a - b);
    return std::min(apart, angle_count_ - apart) <= 2;
  }

  /// Whether no neighbouring place is better at about the same angle (ties: the earlier place keeps
  /// it).
  [[nodiscard]] bool is_local_minimum(int column, int row, const Best& best) const noexcept {
    constexpr int kReach = 2;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        if (!places_.is_place(column + dx, row + dy)) continue;
        for (int sector = 0; sector < kSectorCount; ++sector) {
          const Best rival = best_at(column + dx, row + dy, sector);
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

  /// The cost below which there is room for one more: of equal costs the earlier place keeps its
  /// own.
  static std::int32_t room_below(std::span<const Candidate> sorted, int count) noexcept {
    if (count < static_cast<int>(sorted.size())) return kCostMax + 1;
    return count > 0 ? sorted[count - 1].cost_q10 : 0;
  }

  /// Where there is room; the last of a full list gives way.
  static void insert(const Candidate& candidate, std::span<Candidate> sorted, int& count) noexcept {
    if (count == static_cast<int>(sorted.size())) --count;
    int at = count++;
    for (; at > 0 && precedes(candidate, sorted[at - 1]); --at) sorted[at] = sorted[at - 1];
    sorted[at] = candidate;
  }

  /// The pose of a candidate, and its cost on a scale of its own tilt.
  void finish(Candidate& c) const noexcept {
    const double sx = field_.slope_x(c.column, c.row);
    const double sy = field_.slope_y(c.column, c.row);
    const Tilt tilt = tilt_of(sx, sy);
    const Rotation& turn = memory_.turns[c.angle_index];
    const Rotation rotation = tilt.rotation * turn;
    const Vec3 anchor_work_mm{images_.grid.x_of(c.column), images_.grid.y_of(c.row),
                              field_.plane_mm(c.column, c.row)};
    c.work_T_object = {rotation, anchor_work_mm - rotation * Vec3{anchor_.x_mm, anchor_.y_mm, 0.0}};
    const ProjectedTemplate projected = projector_.at(tilt, turn);
    c.cost_q10 = c.cost_q10 * 1024 / std::max(1, cost_max(images_, projected));
  }

  const SearchImages& images_;
  const TiltField& field_;
  const Places& places_;
  const model::Template& part_;
  const model::Anchor& anchor_;
  int anchor_index_;
  const GridSearchConfig& config_;
  double angle_range_rad_;
  int angle_count_;
  Projector projector_;
  OffsetTable offsets_;
  RiseRange rises_;  // of the angles turned last
  SearchMemory memory_;
};

bool is_valid(const GridSearchConfig& config) noexcept {
  return config.angle_step_rad > 0.0 && config.cost_share_max >= 0.0 &&
         config.cost_share_max <= 1.0;
}

}  // namespace

void reserve_search_scratch(Arena& arena, const rectify::Grid& fine) noexcept {
  const rectify::Grid coarse = image::halved(fine);
  const Lattice widest = make_lattice(coarse.width_px, coarse.height_px, 1, 1);
  const std::size_t place_count =
      static_cast<std::size_t>(widest.padded_width()) * static_cast<std::size_t>(coarse.height_px);
  {
    const ArenaScope scope(arena);
    reserve_image_scratch(arena, coarse);
  }
  {
    const ArenaScope scope(arena);
    reserve_tilt_scratch(arena, coarse.width_px);
  }
  (void)take_search_memory(arena, place_count);
}

double angle_range_rad(const model::Symmetry& symmetry, const model::Anchor& anchor) noexcept {
  if (symmetry.order != model::kFullSymmetry) return 2.0 * kPi / symmetry.order;
  const double dx = anchor.x_mm - symmetry.center_x_mm;
  const double dy = anchor.y_mm - symmetry.center_y_mm;
  const double near_mm = 0.1 * anchor.clearance_mm;
  return dx * dx + dy * dy <= near_mm * near_mm ? 0.0 : 2.0 * kPi;
}

int angle_count(double angle_range_rad, double angle_step_rad) noexcept {
  const double count = std::ceil(angle_range_rad / angle_step_rad);
  return std::clamp(static_cast<int>(std::min(count, 1.0 * kAngleCountMax)), 1, kAngleCountMax);
}

Result<GridSearchResult> grid_search(const SearchImages& images, const TiltField& field,
                                     const Places& places, const model::Template& part,
                                     int anchor_index, const GridSearchConfig& config,
                                     Arena& scratch, std::span<Candidate> candidates) noexcept {
  if (anchor_index < 0 || anchor_index >= part.anchor_count || !is_valid(config)) {
    return Status::kInvalidArgument;
  }
  if (places.width != images.lattice.width || places.height != images.lattice.height ||
      images.grid.width_px != field.rms_mm.width_px ||
      images.grid.height_px != field.rms_mm.height_px) {
    return Status::kShapeMismatch;
  }
  const ArenaScope scope(scratch);
  Search search(images, field, places, part, anchor_index, config);
  if (!search.take_memory(scratch)) return Status::kOutOfMemory;
  search.evaluate_all();
  return GridSearchResult{search.pick(candidates), search.hypothesis_count()};
}

}  // namespace flatpose::search
