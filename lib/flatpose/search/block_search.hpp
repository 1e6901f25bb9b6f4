#pragma once
// The inner loop of the grid search: for one block of places, all angles. A template point is the
// same shift for every place of the block, so the costs of the block are sums of contiguous loads
// (score.hpp says of what). The loop is written once and compiled once for every vector width; each
// form equals the scalar cost in every bit.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "flatpose/core/vector_path.hpp"
#include "flatpose/search/score.hpp"

namespace flatpose::search {

// The best of each quarter of the angles is kept apart at every place, so that a part that is
// nearly symmetric does not lose its true angle to a neighbour's false one.
inline constexpr int kSectorCount = 4;
inline constexpr std::uint8_t kNoAngle = 255;
inline constexpr int kAngleCountMax = 720;

/// The loop keeps what depends on a point's rise in rows of a table.
inline constexpr int kLimitRowBytes = kBlockSize;

/// A template point as the loop takes it.
struct ShiftedPoint {
  std::int32_t offset_bytes = 0;         ///< To its edge, height or normal's x image.
  std::int32_t second_offset_bytes = 0;  ///< To its height (contour), normal's y (surface).
  std::int16_t rise_row_bytes = 0;       ///< Rise, within +-kHeightUnitMax, x kLimitRowBytes.
  std::uint8_t low = 0;                  ///< Normals: the expected x and y.
  std::uint8_t high = 0;
};

/// Farther apart than this heights are alike, clamped as they are.
[[nodiscard]] constexpr std::int32_t bounded_rise(std::int32_t rise_unit) noexcept {
  return std::clamp(rise_unit, -kHeightUnitMax, kHeightUnitMax);
}
[[nodiscard]] constexpr std::int16_t rise_row_bytes(std::int32_t rise_unit) noexcept {
  return static_cast<std::int16_t>(bounded_rise(rise_unit) * kLimitRowBytes);
}

/// All rises of some templates' points lie in it.
struct RiseRange {
  std::int32_t low_unit = -kHeightUnitMax;
  std::int32_t high_unit = kHeightUnitMax;
};

struct ShiftedTemplate {
  std::int32_t contour_count = 0;
  std::int32_t surface_count = 0;
  std::int32_t edge_factor_q8 = 256;
  RiseRange rises;  ///< Of its points; of none the highest below the lowest.
  std::array<ShiftedPoint, kContourCountMax> contour;
  std::array<ShiftedPoint, kSurfaceCountMax> surface;
};

/// Lattice::offset_bytes() of every shift that a template may have: the columns' part plus the
/// rows'.
class OffsetTable {
 public:
  explicit OffsetTable(const Lattice& lattice) noexcept;
  /// Within the lattice's +-reach_px().
  [[nodiscard]] std::int32_t offset_bytes(int dx, int dy) const noexcept {
    return of_columns_[dx + kReachMax_px] + of_rows_[dy + kReachMax_px];
  }

 private:
  std::array<std::int32_t, 2 * kReachMax_px + 1> of_columns_{};
  std::array<std::int32_t, 2 * kReachMax_px + 1> of_rows_{};
};

/// `projected` as the loop takes it; `offsets` are those of the images' lattice.
void shift(const ProjectedTemplate& projected, const SearchImages& images,
           const OffsetTable& offsets, ShiftedTemplate& out) noexcept;
[[nodiscard]] ShiftedTemplate shifted(const ProjectedTemplate& projected,
                                      const SearchImages& images) noexcept;

/// What all angles of a group can do at best, as a node (node_images.hpp) is held against it.
struct GroupTemplate {
  std::int32_t contour_count = 0;
  std::array<ShiftedPoint, kContourCountMax> contour;
};

/// Of all points of all angles; of none the widest.
[[nodiscard]] RiseRange rise_range(std::span<const ShiftedTemplate> angles) noexcept;

struct BlockJob {
  const std::uint8_t* image_bytes = nullptr;  ///< Of the block's first place, first image.
  const std::uint8_t* place_unit = nullptr;   ///< Heights of the block's places.
  const std::uint16_t* bin = nullptr;         ///< Of the block's places.
  std::uint16_t wanted_bin = 0;               ///< Only its places are written to.
  std::span<const ShiftedTemplate> angles;    ///< At most kSectorCount x kNoAngle.
  /// Which of them to look at, in order, if not at all; the others have no cost below the cut-off.
  const std::uint16_t* listed = nullptr;
  int listed_count = 0;
  RiseRange rises;  ///< Of `angles`, or wider; wide ones cost time.
  bool use_height = true;
  std::uint8_t surface_cap = 0;
  std::uint8_t surface_weight = 1;
  std::uint8_t cutoff = 0;  ///< Only costs below it count.
  /// By sector: the lowest cost of every place, and the angle within the sector, kNoAngle for none.
  /// Of equal costs the first angle's. Of a sector without angles to look at nothing is written.
  std::array<std::uint8_t*, kSectorCount> best_cost{};
  std::array<std::uint8_t*, kSectorCount> best_angle{};
};

/// The first angle of a sector; angles are shared out evenly.
[[nodiscard]] constexpr int sector_begin(int sector, int angle_count) noexcept {
  return (sector * angle_count + kSectorCount - 1) / kSectorCount;
}

using SearchBlock = void (*)(const BlockJob&) noexcept;

/// A block of nodes against groups of angles at one tilt.
struct NodeJob {
  const std::uint8_t* image_bytes = nullptr;  ///< Of the block's first node, first node image.
  const std::uint8_t* node_unit = nullptr;    ///< The lowest of its places; kOutsideUnit: none.
  std::span<const GroupTemplate> groups;
  RiseRange rises;
  bool use_height = true;
  std::uint8_t surface_cap = 0;
  std::uint8_t edge_limit = 0;     ///< Edge sums from here on are at the cut-off.
  std::uint64_t* alive = nullptr;  ///< By group: bit i for node i.
};

/// Tells which nodes may hold a hypothesis below the cut-off. Bound: a place's contour point costs
/// d, or min(d, kEdgeCostUnknown) where the height is above place + rise + cap. Both d and
/// min(d, unknown) rise with d, and the cost falls as the height rises or place or rise falls: with
/// the least d, place and rise and the greatest height, each over a set that holds the place's own,
/// it is no higher. Surface points cost nothing or more.
using BoundNodes = void (*)(const NodeJob&) noexcept;
[[nodiscard]] BoundNodes bound_nodes_for(VectorPath path) noexcept;

/// The form for a path; the portable one where this build has no such.
[[nodiscard]] SearchBlock search_block_for(VectorPath path) noexcept;

}  // namespace flatpose::search
