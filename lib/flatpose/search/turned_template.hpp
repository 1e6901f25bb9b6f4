#pragma once
// The sparse template at every angle of the search on the plane of one bin of slopes, as the block
// loops take it.

#include <span>

#include "flatpose/search/block_search.hpp"
#include "flatpose/search/projector.hpp"

namespace flatpose::search {

struct TurnedTemplate {
  std::span<ShiftedTemplate> angles;
  std::span<GroupTemplate> groups;  ///< Of `group_size` neighbouring angles each; none: no nodes.
  int group_size = 1;
  RiseRange rises;
  std::uint8_t cutoff = 0;      ///< Only costs below it count.
  bool is_limited = false;      ///< By the threshold, not the share.
  std::uint8_t edge_limit = 0;  ///< Edge sums from here on cost as much as the cut-off.
};

struct Turns {
  std::span<const Rotation> of_angle;
  double cost_share_max = 1.0;
  std::int32_t threshold = kCostMax;  ///< Costs above it are of no use.
};

class Turner {
 public:
  /// All it is given must outlive it.
  Turner(const SearchImages& images, const Projector& projector, const Turns& turns) noexcept;

  /// `out` brings memory for every angle and, where there are nodes, for as many groups.
  void turn(int bin, TurnedTemplate& out) const noexcept;
  [[nodiscard]] int group_size() const noexcept { return group_size_; }

 private:
  static constexpr int kGroupSizeMax = 8;
  void group(std::span<const ProjectedTemplate> angles, GroupTemplate& out) const noexcept;

  const SearchImages& images_;
  const Projector& projector_;
  const Turns& turns_;
  OffsetTable offsets_;
  OffsetTable node_offsets_;
  int group_size_ = 1;
};

}  // namespace flatpose::search
