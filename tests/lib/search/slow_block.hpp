#pragma once
// A block searched place by place and angle by angle with the scalar cost: what the vectorised loop
// must give.

#include <algorithm>
#include <array>
#include <vector>

#include "flatpose/search/block_search.hpp"
#include "flatpose/search/places.hpp"

namespace flatpose::search {

/// The places of one block, and the templates they are held against.
struct Block {
  int column = 0;  ///< In places.
  int row = 0;
  std::array<std::uint8_t, kBlockSize> place_unit{};
  std::array<std::uint16_t, kBlockSize> bin{};
  std::uint16_t wanted_bin = 0;
  std::uint8_t cutoff = 255;
};

/// By sector and lane.
struct BlockBest {
  static constexpr std::uint8_t kUntouched = 0xAB;
  using Lanes = std::array<std::uint8_t, kBlockSize>;
  std::array<Lanes, kSectorCount> cost;
  std::array<Lanes, kSectorCount> angle;

  BlockBest() {
    for (auto* set : {&cost, &angle}) {
      for (Lanes& lanes : *set) lanes.fill(kUntouched);
    }
  }
};

inline BlockBest fast_block(const SearchImages& images, const Block& block,
                            const std::vector<ShiftedTemplate>& angles, VectorPath path) {
  BlockBest best;
  BlockJob job;
  job.image_bytes = images.bytes.data() + images.lattice.byte_of(block.column, block.row);
  job.place_unit = block.place_unit.data();
  job.bin = block.bin.data();
  job.wanted_bin = block.wanted_bin;
  job.angles = angles;
  job.use_height = images.config.use_height;
  job.surface_cap = static_cast<std::uint8_t>(images.surface_cap);
  job.surface_weight = static_cast<std::uint8_t>(images.surface_weight);
  job.rises = rise_range(angles);
  job.cutoff = block.cutoff;
  for (std::size_t sector = 0; sector < kSectorCount; ++sector) {
    job.best_cost[sector] = best.cost[sector].data();
    job.best_angle[sector] = best.angle[sector].data();
  }
  search_block_for(path)(job);
  return best;
}

inline BlockBest slow_block(const SearchImages& images, const Block& block,
                            const std::vector<ProjectedTemplate>& angles) {
  BlockBest best;
  const int angle_count = static_cast<int>(angles.size());
  const int stride_px = images.lattice.stride_px;
  for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
    if (block.bin[lane] != block.wanted_bin) continue;
    const int x = (block.column + static_cast<int>(lane)) * stride_px;
    const int y = block.row * stride_px;
    for (int sector = 0; sector < kSectorCount; ++sector) {
      const int begin = sector_begin(sector, angle_count);
      if (begin == sector_begin(sector + 1, angle_count)) continue;
      std::int32_t lowest = block.cutoff;
      std::uint8_t at = kNoAngle;
      for (int angle = begin; angle < sector_begin(sector + 1, angle_count); ++angle) {
        const std::int32_t found =
            cost(images, angles[static_cast<std::size_t>(angle)], x, y, block.place_unit[lane]);
        if (found >= lowest) continue;
        lowest = found;
        at = static_cast<std::uint8_t>(angle - begin);
      }
      best.cost[static_cast<std::size_t>(sector)][lane] = static_cast<std::uint8_t>(lowest);
      best.angle[static_cast<std::size_t>(sector)][lane] = at;
    }
  }
  return best;
}

inline std::vector<ShiftedTemplate> all_shifted(const std::vector<ProjectedTemplate>& angles,
                                                const SearchImages& images) {
  std::vector<ShiftedTemplate> out;
  for (const ProjectedTemplate& angle : angles) out.push_back(shifted(angle, images));
  return out;
}

}  // namespace flatpose::search
