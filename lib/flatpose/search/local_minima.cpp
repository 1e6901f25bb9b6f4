#include "flatpose/search/local_minima.hpp"

#include <algorithm>
#include <cstdlib>
#include <tuple>

namespace flatpose::search {
namespace {

constexpr int kPlaceReach = 2;
constexpr int kAngleReach = 2;

class Lister {
 public:
  Lister(const Places& places, const SectorBests& bests, int angle_count,
         const Hypotheses* hypotheses, std::span<std::uint8_t> block_lows,
         std::span<Candidate> minima) noexcept
      : places_(places),
        bests_(bests),
        angle_count_(angle_count),
        hypotheses_(hypotheses),
        block_lows_(block_lows),
        minima_(minima),
        blocks_across_(places.padded_width / kBlockSize) {}

  // From the lowest costs up, so that the list is full of what it will hold before most is looked
  // at.
  int run() noexcept {
    note_lows();
    std::int32_t from = 0;
    for (std::size_t wanted = minima_.size(); from < kCostMax; wanted *= 4) {
      const std::int32_t to = cost_of_some(wanted);
      if (to > from) look_between(from, to);
      from = std::max(from, to);
      if (from >= room_below()) break;
    }
    return count_;
  }

 private:
  struct Best {
    std::int32_t cost;
    std::int32_t angle_index;  // -1: none below the cut-off
  };

  [[nodiscard]] std::size_t low_index(int block, int row, int sector) const noexcept {
    return static_cast<std::size_t>((row * blocks_across_ + block) * kSectorCount + sector);
  }

  void note_lows() noexcept {
    for (int row = 0; row < places_.height; ++row) {
      for (int block = 0; block < blocks_across_; ++block) {
        for (int sector = 0; sector < kSectorCount; ++sector) {
          const std::uint8_t low = lowest(block, row, sector);
          block_lows_[low_index(block, row, sector)] = low;
          ++low_counts_[low];
        }
      }
    }
  }

  [[nodiscard]] std::uint8_t lowest(int block, int row, int sector) const noexcept {
    if (bests_.cost[sector].empty()) return kCostMax;
    const std::uint8_t* costs = bests_.cost[sector].data() + places_.index(block * kBlockSize, row);
    std::array<std::uint8_t, 16> some;
    some.fill(kCostMax);
    for (int i = 0; i < kBlockSize; i += 16) {
      for (int k = 0; k < 16; ++k) some[k] = costs[i + k] < some[k] ? costs[i + k] : some[k];
    }
    std::uint8_t low = kCostMax;
    for (const std::uint8_t cost : some) low = std::min(low, cost);
    return low;
  }

  // The cost below which as many blocks as wanted have something.
  [[nodiscard]] std::int32_t cost_of_some(std::size_t wanted) const noexcept {
    std::size_t count = 0;
    for (std::int32_t cost = 0; cost < kCostMax; ++cost) {
      count += low_counts_[cost];
      if (count >= wanted) return cost + 1;
    }
    return kCostMax;
  }

  void look_between(std::int32_t from, std::int32_t to) noexcept {
    for (int row = 0; row < places_.height; ++row) {
      for (int block = 0; block < blocks_across_; ++block) {
        for (int sector = 0; sector < kSectorCount; ++sector) {
          if (block_lows_[low_index(block, row, sector)] < std::min(to, room_below()))
            look_at(block, row, sector, from, to);
        }
      }
    }
  }

  void look_at(int block, int row, int sector, std::int32_t from, std::int32_t to) noexcept {
    const int first = block * kBlockSize;
    const std::uint8_t* costs = bests_.cost[sector].data() + places_.index(first, row);
    for (int i = 0; i < kBlockSize; ++i) {
      if (costs[i] < from || costs[i] >= std::min(to, room_below())) continue;
      const Best best = best_at(first + i, row, sector);
      if (best.angle_index >= 0 && is_local_minimum(first + i, row, best) &&
          (hypotheses_ == nullptr || hypotheses_->is_wanted(first + i, row, best.angle_index)))
        insert(first + i, row, best);
    }
  }

  [[nodiscard]] Best best_at(int column, int row, int sector) const noexcept {
    if (bests_.angle[sector].empty()) return {kCostMax, -1};
    const std::size_t i = places_.index(column, row);
    const std::uint8_t angle = bests_.angle[sector][i];
    if (angle == kNoAngle) return {kCostMax, -1};
    return {bests_.cost[sector][i], sector_begin(sector, angle_count_) + angle};
  }

  [[nodiscard]] bool angles_are_close(int a, int b) const noexcept {
    const int apart = std::abs(a - b);
    return std::min(apart, angle_count_ - apart) <= kAngleReach;
  }

  [[nodiscard]] bool is_local_minimum(int column, int row, const Best& best) const noexcept {
    for (int dy = -kPlaceReach; dy <= kPlaceReach; ++dy) {
      for (int dx = -kPlaceReach; dx <= kPlaceReach; ++dx) {
        if (!places_.is_place(column + dx, row + dy)) continue;
        for (int sector = 0; sector < kSectorCount; ++sector) {
          const Best rival = best_at(column + dx, row + dy, sector);
          if (rival.angle_index < 0 || rival.cost > best.cost ||
              !angles_are_close(rival.angle_index, best.angle_index))
            continue;
          if (rival.cost < best.cost) return false;
          const bool earlier = dy < 0 || (dy == 0 && dx < 0) ||
                               (dx == 0 && dy == 0 && rival.angle_index < best.angle_index);
          if (earlier) return false;
        }
      }
    }
    return true;
  }

  /// The cost below which a place yet to come has room: those to come are no earlier than those
  /// listed, within one cost; of equal costs the earlier keeps its own.
  [[nodiscard]] std::int32_t room_below() const noexcept {
    if (count_ < static_cast<int>(minima_.size())) return kCostMax + 1;
    return count_ > 0 ? minima_[count_ - 1].cost_q10 + 1 : 0;
  }

  static bool precedes(const Candidate& a, const Candidate& b) noexcept {
    return std::tie(a.cost_q10, a.row, a.column, a.angle_index) <
           std::tie(b.cost_q10, b.row, b.column, b.angle_index);
  }

  /// Where there is room; the last of a full list gives way.
  void insert(int column, int row, const Best& best) noexcept {
    Candidate minimum;
    minimum.cost_q10 = best.cost;
    minimum.angle_index = best.angle_index;
    minimum.column = static_cast<std::int16_t>(column);
    minimum.row = static_cast<std::int16_t>(row);
    if (count_ == static_cast<int>(minima_.size())) {
      if (!precedes(minimum, minima_[count_ - 1])) return;
      --count_;
    }
    int at = count_++;
    for (; at > 0 && precedes(minimum, minima_[at - 1]); --at) minima_[at] = minima_[at - 1];
    minima_[at] = minimum;
  }

  const Places& places_;
  const SectorBests& bests_;
  int angle_count_;
  const Hypotheses* hypotheses_;
  std::span<std::uint8_t> block_lows_;
  std::span<Candidate> minima_;
  int blocks_across_;
  int count_ = 0;
  std::array<std::size_t, kCostMax + 1> low_counts_{};
};

}  // namespace

std::span<std::uint8_t> take_block_lows(Arena& arena, std::size_t place_count) noexcept {
  return arena.take<std::uint8_t>(place_count / kBlockSize * kSectorCount);
}

int list_minima(const Places& places, const SectorBests& bests, int angle_count,
                std::span<std::uint8_t> block_lows, std::span<Candidate> minima,
                const Hypotheses* hypotheses) noexcept {
  return minima.empty() ? 0
                        : Lister(places, bests, angle_count, hypotheses, block_lows, minima).run();
}

}  // namespace flatpose::search
