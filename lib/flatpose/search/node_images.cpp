#include "flatpose/search/node_images.hpp"

#include <algorithm>
#include <array>

#include "flatpose/search/search_images.hpp"

namespace flatpose::search {
namespace {

constexpr int kWindowMax = kNodeSideMax + kNodeSlackMax;
constexpr int kPiece = 256;  // columns at once

struct Least {
  std::uint8_t operator()(std::uint8_t a, std::uint8_t b) const noexcept { return a < b ? a : b; }
};
struct Greatest {
  std::uint8_t operator()(std::uint8_t a, std::uint8_t b) const noexcept { return a > b ? a : b; }
};

/// Pools one image, phase by phase.
template <class Choose>
class Pool {
 public:
  Pool(const SearchImages& images, int source, int target) noexcept
      : from_(images.lattice),
        to_(images.nodes.lattice),
        side_(images.nodes.side),
        window_(images.nodes.side + images.nodes.slack),
        source_(images.bytes.data() +
                static_cast<std::size_t>(source) * images.lattice.image_bytes()),
        target_(images.nodes.bytes.data() +
                static_cast<std::size_t>(target) * images.nodes.lattice.image_bytes()),
        outside_(*source_) {}

  void run() noexcept {
    std::fill_n(target_, to_.image_bytes(), outside_);
    const int s = from_.stride_px;
    for (int phase = 0; phase < s * s; ++phase) {
      for (int row = 1 - window_; row < from_.height; ++row) {
        for (int column = 1 - window_; column < from_.width; column += kPiece)
          pool_piece(phase, column, row);
      }
    }
  }

 private:
  // Windows that begin at `column` and on.
  void pool_piece(int phase, int column, int row) noexcept {
    const int count = std::min(kPiece, from_.width - column);
    std::array<std::uint8_t, kPiece + kWindowMax> across;
    lay_rows(phase, column, row, count + window_ - 1, across.data());
    std::array<std::uint8_t, kPiece> pooled;
    std::copy_n(across.begin(), count, pooled.begin());
    for (int i = 1; i < window_; ++i) {
      for (int n = 0; n < count; ++n) pooled[n] = choose_(pooled[n], across[n + i]);
    }
    hand_out(phase, column, row, count, pooled.data());
  }

  // Of each column the choice of the window's rows. Beyond the margin's first cell all is alike.
  void lay_rows(int phase, int column, int row, int count, std::uint8_t* across) const noexcept {
    const int first = std::max(column, -1);
    const int end = std::min(column + count, from_.width + 1);
    std::fill_n(across, count, outside_);
    for (int i = 0; i < window_; ++i) {
      const std::uint8_t* bytes = source_ + static_cast<std::size_t>(phase) * from_.phase_bytes() +
                                  from_.byte_of(0, std::clamp(row + i, -1, from_.height));
      std::uint8_t* to = across + (first - column);
      if (i == 0) {
        std::copy(bytes + first, bytes + end, to);
      } else {
        for (int n = 0; n < end - first; ++n) to[n] = choose_(to[n], bytes[first + n]);
      }
    }
  }

  // Every side-th window is a node's, in the phase that the first is in.
  void hand_out(int phase, int column, int row, int count, const std::uint8_t* pooled) noexcept {
    const int s = from_.stride_px;
    const int phase_x = phase % s;
    const int phase_y = phase / s;
    const int node_row = (row & -side_) / side_;  // rounded down: a side is a power of two
    const int b = row - node_row * side_;
    for (int n = 0; n < side_ && n < count; ++n) {
      const int node_column = ((column + n) & -side_) / side_;
      const int a = column + n - node_column * side_;
      const int node_phase = (s * b + phase_y) * to_.stride_px + s * a + phase_x;
      if (node_row < -to_.reach || node_row >= to_.height + to_.reach) continue;
      std::uint8_t* to = target_ + static_cast<std::size_t>(node_phase) * to_.phase_bytes() +
                         to_.byte_of(0, node_row) + node_column;
      const int skip = std::max(0, -to_.reach - node_column);
      spread(pooled + n, skip, (count - n + side_ - 1) / side_, to);
    }
  }

  void spread(const std::uint8_t* from, int first, int end, std::uint8_t* to) const noexcept {
    if (side_ == 2) {
      for (int i = first; i < end; ++i) to[i] = from[2 * i];
    } else {
      for (int i = first; i < end; ++i) to[i] = from[4 * i];
    }
  }

  const Lattice& from_;
  const Lattice& to_;
  int side_;
  int window_;
  const std::uint8_t* source_;
  std::uint8_t* target_;
  std::uint8_t outside_;
  Choose choose_;
};

Lattice node_lattice(int width_px, int height_px, int stride_px, int side, int reach_px) noexcept {
  return make_lattice(width_px, height_px, stride_px * side, reach_px);
}

}  // namespace

NodeImages take_node_images(Arena& arena, int width_px, int height_px) noexcept {
  std::size_t most = 0;
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    for (int side = 2; side <= kNodeSideMax; side *= 2) {
      most = std::max(
          most, node_lattice(width_px, height_px, stride_px, side, kReachMax_px).image_bytes());
    }
  }
  NodeImages nodes;
  nodes.bytes = arena.take<std::uint8_t>(NodeImages::kImageCount * most);
  return nodes;
}

void build_node_images(SearchImages& images) noexcept {
  NodeImages& nodes = images.nodes;
  nodes.side = images.config.node_side;
  nodes.slack = images.config.node_slack;
  if (nodes.side == 0) return;
  nodes.lattice = node_lattice(images.grid.width_px, images.grid.height_px,
                               images.lattice.stride_px, nodes.side, images.lattice.reach_px());
  const int count = images.config.use_directions ? image::kOctantCount : 1;
  for (int k = 0; k < count; ++k) Pool<Least>(images, k, k).run();
  if (images.config.use_height)
    Pool<Greatest>(images, SearchImages::kSurfaceImage, NodeImages::kHeightImage).run();
}

}  // namespace flatpose::search
