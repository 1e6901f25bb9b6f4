#include "flatpose/search/grid_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/core/maths.hpp"
#include "flatpose/image/pyramid.hpp"
#include "flatpose/search/bin_search.hpp"
#include "flatpose/search/local_minima.hpp"

namespace flatpose::search {
namespace {

static_assert(kAngleCountMax / kSectorCount < kNoAngle);

// Bins are turned and searched some at a time: as many as their templates' memory holds.
constexpr int kTurnedCountMax = 2 * kAngleCountMax;
constexpr int kBinsAtOnceMax = 128;
// Rows are shared out in so many bands; each place belongs to one.
constexpr int kBandCount = 8;

struct SearchMemory {
  SectorBests bests;
  std::span<TurnedTemplate> turned;  // of the bins at hand
  std::span<ShiftedTemplate> angles;
  std::span<GroupTemplate> groups;
  std::span<Rotation> turns;  // by angle
  std::span<std::uint8_t> block_lows;
  std::span<std::int32_t> row_counts;
};

SearchMemory take_search_memory(Arena& arena, std::size_t place_count, std::size_t row_count,
                                int angles, bool with_nodes) noexcept {
  SearchMemory memory;
  for (int sector = 0; sector < kSectorCount; ++sector) {
    if (sector_begin(sector, angles) == sector_begin(sector + 1, angles)) continue;
    memory.bests.cost[sector] = arena.take<std::uint8_t>(place_count);
    memory.bests.angle[sector] = arena.take<std::uint8_t>(place_count);
  }
  memory.block_lows = take_block_lows(arena, place_count);
  memory.row_counts = arena.take<std::int32_t>(row_count);
  memory.turned = arena.take<TurnedTemplate>(kBinsAtOnceMax);
  memory.angles = arena.take<ShiftedTemplate>(kTurnedCountMax);
  memory.groups = arena.take<GroupTemplate>(with_nodes ? kTurnedCountMax : 0);
  memory.turns = arena.take<Rotation>(kAngleCountMax);
  return memory;
}

class Search {
 public:
  Search(const SearchImages& images, const TiltField& field, const Places& places,
         const model::Template& part, int anchor_index, const GridSearchConfig& config,
         const Budget& budget) noexcept
      : budget_(budget),
        images_(images),
        field_(field),
        places_(places),
        anchor_(part.anchors[anchor_index]),
        anchor_index_(anchor_index),
        config_(config),
        angle_range_rad_(angle_range_rad(part.symmetry, anchor_)),
        angle_count_(angle_count(angle_range_rad_, config.angle_step_rad)),
        projector_(part, anchor_, images, config.score, !images.config.use_height,
                   config.vector_path) {}

  bool take_memory(Arena& scratch) noexcept {
    memory_ = take_search_memory(scratch, places_.index(0, places_.height),
                                 static_cast<std::size_t>(places_.height), angle_count_,
                                 images_.nodes.side > 0);
    if (scratch.failed()) return false;
    for (int angle = 0; angle < angle_count_; ++angle)
      memory_.turns[angle] = rotation_about_z(angle_rad(angle));
    return true;
  }

  /// Local minima among neighbours in place and angle, best first, at most as many as `candidates`
  /// holds. A threshold takes none away that costs no more, nor makes one: it is rivals that cost
  /// no more which decide whether a place is a minimum. So a full list is the list.
  Result<int> run(std::span<Candidate> candidates) noexcept {
    const auto first = static_cast<std::int32_t>(config_.first_share * kCostMax);
    int count = 0;
    for (const std::int32_t threshold : {std::min(first, kCostMax), kCostMax}) {
      evaluate_all(threshold);
      if (budget_.is_over()) return Status::kStopped;
      const Hypotheses wanted = hypotheses();
      count = list_minima(places_, memory_.bests, angle_count_, memory_.block_lows, candidates,
                          config_.origins == nullptr ? nullptr : &wanted);
      if (!is_limited_ || count == static_cast<int>(candidates.size())) break;
    }
    for (Candidate& c : candidates.first(static_cast<std::size_t>(count))) finish(c);
    return count;
  }

  [[nodiscard]] std::int64_t evaluated_count() const noexcept {
    std::int64_t sum = 0;
    for (const std::int64_t count : evaluated_counts_) sum += count;
    return sum;
  }
  [[nodiscard]] std::int64_t hypothesis_count() const noexcept {
    return places_.place_count * angle_count_;
  }

 private:
  void evaluate_all(std::int32_t threshold) noexcept {
    for (const auto& cost : memory_.bests.cost) std::fill(cost.begin(), cost.end(), kCostMax);
    for (const auto& angle : memory_.bests.angle) std::fill(angle.begin(), angle.end(), kNoAngle);
    share_out_rows();
    is_limited_ = false;
    evaluated_counts_.fill(0);
    for (int bin = 0; bin < kBinCount && !budget_.was_over();) {
      bin = gather_bins(bin);
      turn_bins(threshold);
      search_bins();
    }
  }

  // As many blocks in each band, and rows of nodes undivided.
  void share_out_rows() noexcept {
    constexpr int kRowsAlike = kNodeSideMax;
    const std::int32_t total = places_.bin_begin[kBinCount];
    const std::span<std::int32_t> counts = memory_.row_counts;
    std::fill(counts.begin(), counts.end(), 0);
    for (std::int32_t i = 0; i < total; ++i) ++counts[places_.blocks[i].row / kRowsAlike];
    std::int64_t so_far = 0;
    int group = 0;
    for (int band = 0; band < kBandCount; ++band) {
      row_end_[band] = places_.height;
      while (so_far * kBandCount < static_cast<std::int64_t>(total) * (band + 1) &&
             group < static_cast<int>(counts.size()))
        so_far += counts[group++];
      if (band + 1 < kBandCount) row_end_[band] = std::min(group * kRowsAlike, places_.height);
    }
  }

  // The next bins that have places, up to what the memory holds. Returns the bin to go on from.
  int gather_bins(int bin) noexcept {
    bins_at_hand_ = 0;
    const int most = std::min(kBinsAtOnceMax, kTurnedCountMax / angle_count_);
    for (; bin < kBinCount && bins_at_hand_ < most; ++bin) {
      if (places_.bin_begin[bin] < places_.bin_begin[bin + 1]) bins_[bins_at_hand_++] = bin;
    }
    return bin;
  }

  void turn_bins(std::int32_t threshold) noexcept {
    const Turns turns{memory_.turns.first(static_cast<std::size_t>(angle_count_)),
                      config_.cost_share_max, threshold};
    const Turner turner(images_, projector_, turns);
    const auto each = static_cast<std::size_t>(angle_count_);
    const int chunk_count = std::min(kBandCount, bins_at_hand_);
    auto turn_some = [&](int chunk) {
      for (int i = chunk; i < bins_at_hand_ && !budget_.is_over(); i += chunk_count) {
        const std::size_t first = static_cast<std::size_t>(i) * each;
        TurnedTemplate& turned = memory_.turned[i];
        turned = TurnedTemplate{};
        turned.angles = memory_.angles.subspan(first, each);
        if (!memory_.groups.empty()) turned.groups = memory_.groups.subspan(first, each);
        turner.turn(bins_[i], turned);
      }
    };
    if (!for_each_chunk(budget_, chunk_count, turn_some)) return;
    for (int i = 0; i < bins_at_hand_; ++i) is_limited_ |= memory_.turned[i].is_limited;
  }

  void search_bins() noexcept {
    auto search_band = [&](int band) {
      int until_look = kBlocksPerLook;
      const int row_begin = band > 0 ? row_end_[band - 1] : 0;
      for (int i = 0; i < bins_at_hand_; ++i) {
        const BinJob job{images_,
                         places_,
                         memory_.turned[i],
                         memory_.bests,
                         search_block_for(config_.vector_path),
                         bound_nodes_for(config_.vector_path)};
        const int begin = first_block(bins_[i], row_begin);
        const int end = first_block(bins_[i], row_end_[band]);
        evaluated_counts_[band] += search_in_pieces(job, begin, end, until_look);
      }
    };
    (void)for_each_chunk(budget_, kBandCount, search_band);
  }

  // Blocks of one bin, with a look at the budget whenever `until_look` of them are done; nodes go
  // by whole rows.
  [[nodiscard]] std::int64_t search_in_pieces(const BinJob& job, int begin, int end,
                                              int& until_look) const noexcept {
    std::int64_t evaluated_count = 0;
    while (begin < end && !budget_.was_over()) {
      const int next = images_.nodes.side > 0 ? end : std::min(end, begin + until_look);
      evaluated_count += search_bin(job, begin, next);
      until_look -= next - begin;
      begin = next;
      if (until_look > 0) continue;
      (void)budget_.is_over();
      until_look = kBlocksPerLook;
    }
    return evaluated_count;
  }

  // The first of the bin's blocks that is not above `row`.
  [[nodiscard]] int first_block(int bin, int row) const noexcept {
    const PlaceBlock* const first = places_.blocks.data() + places_.bin_begin[bin];
    const PlaceBlock* const last = places_.blocks.data() + places_.bin_begin[bin + 1];
    const PlaceBlock* const found = std::partition_point(
        first, last, [row](const PlaceBlock& block) { return block.row < row; });
    return static_cast<int>(found - places_.blocks.data());
  }

  [[nodiscard]] Hypotheses hypotheses() const noexcept {
    return {field_,
            images_.grid,
            anchor_,
            memory_.turns,
            images_.lattice.stride_px,
            config_.origins,
            config_.origin_margin_mm};
  }

  [[nodiscard]] std::int16_t cell_of(int place) const noexcept {
    return static_cast<std::int16_t>(place * images_.lattice.stride_px);
  }

  [[nodiscard]] double angle_rad(int index) const noexcept {
    return angle_range_rad_ * index / angle_count_;
  }

  // From places to cells and a pose; the cost as a share of the worst at its own tilt.
  void finish(Candidate& c) const noexcept {
    c.column = cell_of(c.column);
    c.row = cell_of(c.row);
    c.anchor = static_cast<std::int16_t>(anchor_index_);
    const double sx = field_.slope_x(c.column, c.row);
    const double sy = field_.slope_y(c.column, c.row);
    const Tilt tilt = tilt_of(sx, sy);
    const Rotation& turn = memory_.turns[c.angle_index];
    const Rotation rotation = tilt.rotation * turn;
    c.work_T_object = hypotheses().work_T_object(c.column, c.row, rotation);
    const ProjectedTemplate projected = projector_.at(tilt, turn);
    c.cost_q10 = c.cost_q10 * 1024 / std::max(1, cost_max(images_, projected));
  }

  const Budget& budget_;
  const SearchImages& images_;
  const TiltField& field_;
  const Places& places_;
  const model::Anchor& anchor_;
  int anchor_index_;
  const GridSearchConfig& config_;
  double angle_range_rad_;
  int angle_count_;
  Projector projector_;
  SearchMemory memory_;
  std::array<int, kBandCount> row_end_{};
  std::array<std::int64_t, kBandCount> evaluated_counts_{};
  std::array<int, kBinsAtOnceMax> bins_{};
  int bins_at_hand_ = 0;
  bool is_limited_ = false;  // whether the threshold left out anything that may count
};

bool is_valid(const GridSearchConfig& config) noexcept {
  return config.angle_step_rad > 0.0 && config.cost_share_max >= 0.0 &&
         config.cost_share_max <= 1.0 && config.first_share >= 0.0;
}

}  // namespace

void reserve_search_scratch(Arena& arena, const rectify::Grid& fine, bool with_nodes) noexcept {
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
  (void)take_search_memory(arena, place_count, static_cast<std::size_t>(coarse.height_px),
                           kAngleCountMax, with_nodes);
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
                                     Arena& scratch, std::span<Candidate> candidates,
                                     const Budget& budget) noexcept {
  if (anchor_index < 0 || anchor_index >= part.anchor_count || !is_valid(config)) {
    return Status::kInvalidArgument;
  }
  if (places.width != images.lattice.width || places.height != images.lattice.height ||
      images.grid.width_px != field.rms_mm.width_px ||
      images.grid.height_px != field.rms_mm.height_px) {
    return Status::kShapeMismatch;
  }
  const ArenaScope scope(scratch);
  Search search(images, field, places, part, anchor_index, config, budget);
  if (!search.take_memory(scratch)) return Status::kOutOfMemory;
  GridSearchResult result;
  const Result<int> count = search.run(candidates);
  if (!count) return count.status();
  result.candidate_count = *count;
  result.hypothesis_count = search.hypothesis_count();
  result.evaluated_count = search.evaluated_count();
  return result;
}

}  // namespace flatpose::search
