#pragma once
// The places that the planarity gate leaves: where a plane fits the surface around a cell of the
// lattice, there an anchor of the part may lie, with the tilt that the plane has. Places are
// grouped by tilt, so that a template turned once serves all of a group, and by blocks of
// neighbours, so that one load serves all of a block.

#include <cstdint>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/search/lattice.hpp"
#include "flatpose/search/search_images.hpp"
#include "flatpose/search/tilt_field.hpp"

namespace flatpose::search {

/// Slopes are binned: a bin of 0.08 is 4.6 degrees wide on the flat.
inline constexpr double kSlopeBin = 0.08;
inline constexpr int kSlopeBinReach = 24;
inline constexpr int kSlopeBinsAcross = 2 * kSlopeBinReach + 1;
inline constexpr int kBinCount = kSlopeBinsAcross * kSlopeBinsAcross;
inline constexpr std::uint16_t kNoBin = 0xFFFF;

[[nodiscard]] constexpr double slope_x_of_bin(int bin) noexcept {
  return (bin % kSlopeBinsAcross - kSlopeBinReach) * kSlopeBin;
}
[[nodiscard]] constexpr double slope_y_of_bin(int bin) noexcept {
  return (bin / kSlopeBinsAcross - kSlopeBinReach) * kSlopeBin;
}

/// Up to kBlockSize neighbours in a row, of which some have the bin's tilt.
struct PlaceBlock {
  std::uint16_t bin = 0;
  std::int16_t row = 0;
  std::int16_t column = 0;  ///< Of the first, a multiple of kBlockSize.
};

/// Below a right angle, from which on the tangent bounds nothing.
inline constexpr double kTiltMax_rad = 1.57;

struct PlaceConfig {
  int stride_px = 1;          ///< 1..kStrideMax_px.
  double max_tilt_rad = 0.8;  ///< Steeper places are no hypotheses; 0..kTiltMax_rad.
  double planarity_mm = 0.5;  ///< Places whose plane fit leaves more than this are no hypotheses.
};

struct Places {
  int width = 0;
  int height = 0;
  int padded_width = 0;          ///< A multiple of kBlockSize.
  std::span<std::uint16_t> bin;  ///< Of every place of the lattice; kNoBin: not planar.
  std::span<std::uint8_t> height_unit;
  std::span<PlaceBlock> blocks;  ///< By bin, row, column.
  std::span<PlaceBlock> unsorted;
  std::span<std::int32_t> bin_begin;  ///< Into blocks; kBinCount + 1.
  std::int64_t place_count = 0;
  HeightRange range;  ///< Of the planes at the places.

  [[nodiscard]] std::size_t index(int column, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(padded_width) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] bool is_place(int column, int row) const noexcept {
    return column >= 0 && row >= 0 && column < width && row < height &&
           bin[index(column, row)] != kNoBin;
  }
};

/// Takes memory for the places of any stride on a coarse level of this size.
[[nodiscard]] Places take_places(Arena& arena, int width_px, int height_px) noexcept;

/// Gates and groups the cells of the field.  Cost: one pass, linear in cells.
/// Fails: kInvalidArgument (a stride or tilt out of its range), kShapeMismatch (places of a smaller
/// field).
Status collect_places(const TiltField& field, const PlaceConfig& config, Places& places) noexcept;

/// The planes' heights in the images' units.
void set_heights(const TiltField& field, const SearchImages& images, Places& places) noexcept;

}  // namespace flatpose::search
