#include "flatpose/search/bin_search.hpp"

#include <algorithm>
#include <bit>

namespace flatpose::search {
namespace {

/// Blocks of places whose nodes lie in one block of nodes.
class NodeBlock {
 public:
  NodeBlock(const BinJob& job, int row, int column) noexcept
      : job_(job), side_(job.images.nodes.side), row_(row), column_(column) {
    node_unit_.fill(kOutsideUnit);
  }

  void add(const PlaceBlock& block) noexcept {
    Member& member = members_[member_count_++];
    member.block = block;
    const std::size_t first = job_.places.index(block.column, block.row);
    const std::uint16_t* bin = job_.places.bin.data() + first;
    const std::uint8_t* unit = job_.places.height_unit.data() + first;
    member.first_node = (block.column - column_ * side_ * kBlockSize) / side_;
    std::array<std::uint8_t, kBlockSize> wanted;  // the places' units, others' out of the way
    for (int i = 0; i < kBlockSize; ++i) {
      const bool is_wanted = bin[i] == block.bin;
      wanted[i] = is_wanted ? unit[i] : kOutsideUnit;
      member.place_count += is_wanted ? 1 : 0;
    }
    std::uint8_t* nodes = node_unit_.data() + member.first_node;
    for (int i = 0; i < kBlockSize / side_; ++i) {
      for (int k = 0; k < side_; ++k) nodes[i] = std::min(nodes[i], wanted[i * side_ + k]);
    }
  }

  std::int64_t search() const noexcept {
    std::array<std::uint64_t, kAngleCountMax> alive;
    bound(alive.data());
    std::int64_t evaluated_count = 0;
    for (int i = 0; i < member_count_; ++i) {
      const Member& member = members_[i];
      const std::uint64_t nodes = (~std::uint64_t{0} >> (kBlockSize - kBlockSize / side_))
                                  << member.first_node;
      std::array<std::uint16_t, kAngleCountMax> listed;
      const int count = list(alive.data(), nodes, listed.data());
      if (count == 0) continue;
      search_places(job_, member.block, listed.data(), count);
      evaluated_count += static_cast<std::int64_t>(count) * member.place_count;
    }
    return evaluated_count;
  }

  static void search_places(const BinJob& job, const PlaceBlock& block, const std::uint16_t* listed,
                            int count) noexcept {
    const SearchImages& images = job.images;
    const std::size_t first = job.places.index(block.column, block.row);
    BlockJob to;
    to.image_bytes = images.bytes.data() + images.lattice.byte_of(block.column, block.row);
    to.place_unit = job.places.height_unit.data() + first;
    to.bin = job.places.bin.data() + first;
    to.wanted_bin = block.bin;
    to.angles = job.turned.angles;
    to.listed = listed;
    to.listed_count = count;
    to.rises = job.turned.rises;
    to.use_height = images.config.use_height;
    to.surface_cap = static_cast<std::uint8_t>(images.surface_cap);
    to.surface_weight = static_cast<std::uint8_t>(images.surface_weight);
    to.cutoff = job.turned.cutoff;
    for (int sector = 0; sector < kSectorCount; ++sector) {
      if (job.bests.cost[sector].empty()) continue;  // no angles, nothing written
      to.best_cost[sector] = job.bests.cost[sector].data() + first;
      to.best_angle[sector] = job.bests.angle[sector].data() + first;
    }
    job.search_block(to);
  }

 private:
  struct Member {
    PlaceBlock block;
    int first_node = 0;  // of the block of nodes
    int place_count = 0;
  };

  void bound(std::uint64_t* alive) const noexcept {
    const SearchImages& images = job_.images;
    NodeJob to;
    to.image_bytes =
        images.nodes.bytes.data() + images.nodes.lattice.byte_of(column_ * kBlockSize, row_);
    to.node_unit = node_unit_.data();
    to.groups = job_.turned.groups;
    to.rises = job_.turned.rises;
    to.use_height = images.config.use_height;
    to.surface_cap = static_cast<std::uint8_t>(images.surface_cap);
    to.edge_limit = job_.turned.edge_limit;
    to.alive = alive;
    job_.bound_nodes(to);
  }

  // The angles of groups of which a node among `nodes` is alive.
  int list(const std::uint64_t* alive, std::uint64_t nodes, std::uint16_t* listed) const noexcept {
    const int angle_count = static_cast<int>(job_.turned.angles.size());
    const int size = job_.turned.group_size;
    const int group_count = static_cast<int>(job_.turned.groups.size());
    int count = 0;
    for (int group = 0; group < group_count; ++group) {
      if ((alive[group] & nodes) == 0) continue;
      const int end = std::min((group + 1) * size, angle_count);
      for (int angle = group * size; angle < end; ++angle)
        listed[count++] = static_cast<std::uint16_t>(angle);
    }
    return count;
  }

  const BinJob& job_;
  int side_;
  int row_;
  int column_;
  std::array<std::uint8_t, kBlockSize> node_unit_;
  std::array<Member, kNodeSideMax * kNodeSideMax> members_;
  int member_count_ = 0;
};

/// The blocks of one row of nodes.
std::int64_t search_row(const BinJob& job, std::span<const PlaceBlock> blocks) noexcept {
  const int side = job.images.nodes.side;
  const int node_row = blocks[0].row / side;
  const int across = side * kBlockSize;
  int column_count = 0;
  for (const PlaceBlock& block : blocks)
    column_count = std::max(column_count, block.column / across + 1);
  std::int64_t evaluated_count = 0;
  for (int column = 0; column < column_count; ++column) {
    NodeBlock nodes(job, node_row, column);
    bool has_any = false;
    for (const PlaceBlock& block : blocks) {
      if (block.column / across != column) continue;
      nodes.add(block);
      has_any = true;
    }
    if (has_any) evaluated_count += nodes.search();
  }
  return evaluated_count;
}

std::int64_t search_whole(const BinJob& job, std::span<const PlaceBlock> blocks) noexcept {
  std::int64_t place_count = 0;
  for (const PlaceBlock& block : blocks) {
    NodeBlock::search_places(job, block, nullptr, 0);
    const std::uint16_t* bin = job.places.bin.data() + job.places.index(block.column, block.row);
    for (int i = 0; i < kBlockSize; ++i) place_count += bin[i] == block.bin ? 1 : 0;
  }
  return place_count * static_cast<std::int64_t>(job.turned.angles.size());
}

}  // namespace

std::int64_t search_bin(const BinJob& job, int begin, int end) noexcept {
  const std::span<const PlaceBlock> blocks = job.places.blocks.subspan(
      static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  const int side = job.images.nodes.side;
  if (side == 0) return search_whole(job, blocks);
  std::int64_t evaluated_count = 0;
  for (std::size_t first = 0; first < blocks.size();) {
    std::size_t last = first;
    while (last < blocks.size() && blocks[last].row / side == blocks[first].row / side) ++last;
    evaluated_count += search_row(job, blocks.subspan(first, last - first));
    first = last;
  }
  return evaluated_count;
}

}  // namespace flatpose::search
