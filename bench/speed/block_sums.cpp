#include "bench/speed/block_sums.hpp"

#include <algorithm>
#include <iterator>

#include "flatpose/core/fnv.hpp"

namespace flatpose::bench {

BlockSums::BlockSums(const Ground& ground) : ground_(ground), angle_count_(ground.angle_count()) {
  for (int bin = 0; bin < search::kBinCount; ++bin) {
    const auto at = static_cast<std::size_t>(bin);
    const Bin next{ground.places.bin_begin[at], ground.places.bin_begin[at + 1], 0, {}, 0};
    if (next.begin == next.end) continue;
    bins_.push_back(next);
    turn_template(bin, bins_.back());
  }
  for (auto& cost : best_cost_) cost.resize(ground.places.bin.size());
  for (auto& angle : best_angle_) angle.resize(ground.places.bin.size());
}

void BlockSums::turn_template(int bin_index, Bin& bin) {
  bin.first_angle = angles_.size();
  const model::Template& part = *ground_.part;
  const double range_rad = search::angle_range_rad(part.symmetry, part.anchors[0]);
  std::int32_t worst = 0;
  for (int i = 0; i < angle_count_; ++i) {
    const search::ProjectedTemplate projected = search::project(
        part, part.anchors[0], search::slope_x_of_bin(bin_index), search::slope_y_of_bin(bin_index),
        range_rad * i / angle_count_, ground_.images, ground_.search.score);
    angles_.push_back(search::shifted(projected, ground_.images));
    worst = std::max(worst, search::cost_max(ground_.images, projected));
  }
  bin.rises = search::rise_range(
      {angles_.data() + bin.first_angle, static_cast<std::size_t>(angle_count_)});
  bin.cutoff = static_cast<std::uint8_t>(
      std::min(static_cast<std::int32_t>(worst * ground_.search.cost_share_max), search::kCostMax));
}

void BlockSums::run(search::SearchBlock form) {
  const search::Places& places = ground_.places;
  search::BlockJob job;
  job.use_height = ground_.images.config.use_height;
  job.surface_cap = static_cast<std::uint8_t>(ground_.images.surface_cap);
  job.surface_weight = static_cast<std::uint8_t>(ground_.images.surface_weight);
  for (const Bin& bin : bins_) {
    job.angles = {angles_.data() + bin.first_angle, static_cast<std::size_t>(angle_count_)};
    job.rises = bin.rises;
    job.cutoff = bin.cutoff;
    for (int i = bin.begin; i < bin.end; ++i) {
      const search::PlaceBlock& block = places.blocks[static_cast<std::size_t>(i)];
      const std::size_t first = places.index(block.column, block.row);
      job.image_bytes =
          ground_.images.bytes.data() + ground_.images.lattice.byte_of(block.column, block.row);
      job.place_unit = places.height_unit.data() + first;
      job.bin = places.bin.data() + first;
      job.wanted_bin = block.bin;
      for (std::size_t sector = 0; sector < search::kSectorCount; ++sector) {
        job.best_cost[sector] = best_cost_[sector].data() + first;
        job.best_angle[sector] = best_angle_[sector].data() + first;
      }
      form(job);
    }
  }
}

void BlockSums::add_round() {
  const model::Template& part = *ground_.part;
  const double range_rad = search::angle_range_rad(part.symmetry, part.anchors[0]);
  std::vector<Rotation> rotations;
  for (int i = 0; i < angle_count_; ++i)
    rotations.push_back(rotation_about_z(range_rad * i / angle_count_));
  const search::Projector projector(part, part.anchors[0], ground_.images, ground_.search.score,
                                    !ground_.images.config.use_height);
  const double share = rounds_.empty() ? ground_.search.first_share : 1.0;
  const search::Turns turns{rotations, ground_.search.cost_share_max,
                            static_cast<std::int32_t>(share * search::kCostMax)};
  Round& round = rounds_.emplace_back();
  const search::Turner turner(ground_.images, projector, turns);
  const auto each = static_cast<std::size_t>(angle_count_);
  round.angles.resize(bins_.size() * each);
  round.groups.resize(bins_.size() * each);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    search::TurnedTemplate& turned = round.turned.emplace_back();
    turned.angles = {round.angles.data() + i * each, each};
    turned.groups = {round.groups.data() + i * each, each};
    turner.turn(ground_.places.blocks[static_cast<std::size_t>(bins_[i].begin)].bin, turned);
  }
}

search::SectorBests BlockSums::bests() {
  search::SectorBests bests;
  for (std::size_t sector = 0; sector < search::kSectorCount; ++sector) {
    bests.cost[sector] = best_cost_[sector];
    bests.angle[sector] = best_angle_[sector];
  }
  return bests;
}

void BlockSums::prune(VectorPath path) {
  if (rounds_.empty()) add_round();
  const search::SectorBests all = bests();
  for (const Round& round : rounds_) {
    for (auto& cost : best_cost_) std::fill(cost.begin(), cost.end(), search::kCostMax);
    for (auto& angle : best_angle_) std::fill(angle.begin(), angle.end(), search::kNoAngle);
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      const search::BinJob job{ground_.images,
                               ground_.places,
                               round.turned[i],
                               all,
                               search::search_block_for(path),
                               search::bound_nodes_for(path)};
      search::search_bin(job, bins_[i].begin, bins_[i].end);
    }
  }
}

std::vector<search::Candidate> BlockSums::candidates(std::size_t count) {
  std::vector<search::Candidate> list(count);
  std::vector<std::uint8_t> lows(ground_.places.bin.size() / search::kBlockSize *
                                 search::kSectorCount);
  list.resize(static_cast<std::size_t>(
      search::list_minima(ground_.places, bests(), angle_count_, lows, list)));
  return list;
}

std::uint64_t BlockSums::digest() const {
  Fnv1a64 fnv;
  for (const auto& cost : best_cost_) fnv.add(std::as_bytes(std::span(cost)));
  return fnv.value();
}

double BlockSums::loaded_bytes(int lane_count) const {
  const search::ScoreConfig& score = ground_.search.score;
  // Contour: distance, and what may hide it; surface: a height, or two components of a normal.
  const bool use_height = ground_.images.config.use_height;
  const int loads =
      score.contour_count * (use_height ? 2 : 1) + score.surface_count * (use_height ? 1 : 2);
  std::int64_t vector_count = 0;  // from the first wanted place to the last
  for (const search::PlaceBlock& block : ground_.places.blocks.first(block_count())) {
    const auto begin = ground_.places.bin.begin() +
                       static_cast<std::ptrdiff_t>(ground_.places.index(block.column, block.row));
    const auto end = begin + search::kBlockSize;
    const auto first = std::find(begin, end, block.bin);
    const auto last =
        std::find(std::reverse_iterator(end), std::reverse_iterator(first), block.bin);
    vector_count += (last.base() - first + lane_count - 1) / lane_count;
  }
  return static_cast<double>(vector_count) * lane_count * angle_count_ * loads;
}

std::size_t BlockSums::block_count() const {
  return bins_.empty() ? 0 : static_cast<std::size_t>(bins_.back().end);
}

}  // namespace flatpose::bench
