#pragma once
// The sums of the grid search alone: every block of places through one form of the block loop, with
// templates that were turned beforehand. Table 4.1 of Ingberg 2015 leaves pre-computations out, and
// two forms of the loop can be compared only where nothing else runs.

#include <array>
#include <vector>

#include "bench/speed/ground.hpp"
#include "flatpose/search/bin_search.hpp"

namespace flatpose::bench {

class BlockSums {
 public:
  explicit BlockSums(const Ground& ground);

  /// Fills the best cost and angle of every place. The same bits for every exact form.
  void run(search::SearchBlock form);

  /// As run(), but what cannot enter the list of candidates is left out: by the threshold of the
  /// search's first round and, where the ground has nodes, by their bounds.
  void prune(VectorPath path);
  [[nodiscard]] int round_count() const { return static_cast<int>(rounds_.size()); }
  /// One more round: the first at the ground's threshold, the second, for where that is not
  /// enough, at none.
  void add_round();
  /// Fills the list from the costs of the last run() or prune().
  [[nodiscard]] std::vector<search::Candidate> candidates(std::size_t count);

  /// Over the costs of all places and sectors.
  [[nodiscard]] std::uint64_t digest() const;
  /// That a form of this vector width loads from the images if it never ends early.
  [[nodiscard]] double loaded_bytes(int lane_count) const;

 private:
  struct Bin {
    int begin = 0;  ///< Of its blocks.
    int end = 0;
    std::size_t first_angle = 0;
    search::RiseRange rises;
    std::uint8_t cutoff = 0;
  };
  [[nodiscard]] std::size_t block_count() const;
  void turn_template(int bin_index, Bin& bin);
  [[nodiscard]] search::SectorBests bests();

  const Ground& ground_;
  int angle_count_;
  std::vector<Bin> bins_;
  std::vector<search::ShiftedTemplate> angles_;  // by bin
  std::array<std::vector<std::uint8_t>, search::kSectorCount> best_cost_;
  std::array<std::vector<std::uint8_t>, search::kSectorCount> best_angle_;
  struct Round {
    std::vector<search::ShiftedTemplate> angles;
    std::vector<search::GroupTemplate> groups;
    std::vector<search::TurnedTemplate> turned;  // by bin
  };
  std::vector<Round> rounds_;
};

}  // namespace flatpose::bench
