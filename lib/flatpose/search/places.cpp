#include "flatpose/search/places.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/core/maths.hpp"

namespace flatpose::search {
namespace {

int slope_bin(double slope) noexcept {
  return static_cast<int>(std::floor(slope / kSlopeBin + 0.5));
}

bool is_valid(const PlaceConfig& config) noexcept {
  return config.stride_px >= 1 && config.stride_px <= kStrideMax_px && config.max_tilt_rad >= 0.0 &&
         config.max_tilt_rad <= kTiltMax_rad;
}

double slope_limit(double max_tilt_rad) noexcept {
  const auto [s, c] = sin_cos(max_tilt_rad);
  return std::min(s / c, kSlopeBin * kSlopeBinReach);
}

class Collector {
 public:
  Collector(const TiltField& field, const PlaceConfig& config, Places& places) noexcept
      : field_(field),
        config_(config),
        places_(places),
        slope_limit_(slope_limit(config.max_tilt_rad)) {}

  void run() noexcept {
    std::fill(places_.bin.begin(), places_.bin.end(), kNoBin);
    places_.place_count = 0;
    places_.range = {};
    block_count_ = 0;
    for (int row = 0; row < places_.height; ++row) {
      for (int column = 0; column < places_.width; column += kBlockSize) gate_block(column, row);
    }
    sort_by_bin();
  }

 private:
  void gate_block(int first_column, int row) noexcept {
    const int end = std::min(first_column + kBlockSize, places_.width);
    const int first_block = block_count_;
    for (int column = first_column; column < end; ++column) {
      const int x = column * config_.stride_px;
      const int y = row * config_.stride_px;
      if (!is_planar(x, y)) continue;
      const int bin = (slope_bin(field_.slope_y(x, y)) + kSlopeBinReach) * kSlopeBinsAcross +
                      slope_bin(field_.slope_x(x, y)) + kSlopeBinReach;
      places_.bin[places_.index(column, row)] = static_cast<std::uint16_t>(bin);
      note_height(static_cast<double>(field_.plane_mm(x, y)));
      ++places_.place_count;
      note_bin(first_block, bin, first_column, row);
    }
  }

  [[nodiscard]] bool is_planar(int x, int y) const noexcept {
    if (!(field_.rms_mm(x, y) <= config_.planarity_mm)) return false;  // NaN at the border
    const double sx = field_.slope_x(x, y);
    const double sy = field_.slope_y(x, y);
    return sx * sx + sy * sy <= slope_limit_ * slope_limit_;
  }

  void note_height(double plane_mm) noexcept {
    HeightRange& range = places_.range;
    range.low_mm = places_.place_count == 0 ? plane_mm : std::min(range.low_mm, plane_mm);
    range.high_mm = places_.place_count == 0 ? plane_mm : std::max(range.high_mm, plane_mm);
  }

  // One entry a block and bin; a block holds few bins.
  void note_bin(int first_block, int bin, int column, int row) noexcept {
    for (int i = block_count_ - 1; i >= first_block; --i) {
      if (places_.unsorted[i].bin == bin) return;
    }
    places_.unsorted[block_count_++] = {static_cast<std::uint16_t>(bin),
                                        static_cast<std::int16_t>(row),
                                        static_cast<std::int16_t>(column)};
  }

  void sort_by_bin() noexcept {  // counting sort, stable
    const std::span<std::int32_t> begin = places_.bin_begin;
    std::fill(begin.begin(), begin.end(), 0);
    for (int i = 0; i < block_count_; ++i) ++begin[places_.unsorted[i].bin + 1];
    for (int bin = 0; bin < kBinCount; ++bin) begin[bin + 1] += begin[bin];
    for (int i = block_count_ - 1; i >= 0; --i)
      places_.blocks[--begin[places_.unsorted[i].bin + 1]] = places_.unsorted[i];
    // Every begin now stands one bin too high: entry b + 1 is where bin b starts.
    for (int bin = 0; bin < kBinCount; ++bin) begin[bin] = begin[bin + 1];
    begin[kBinCount] = block_count_;
  }

  const TiltField& field_;
  const PlaceConfig& config_;
  Places& places_;
  double slope_limit_;
  int block_count_ = 0;
};

}  // namespace

Places take_places(Arena& arena, int width_px, int height_px) noexcept {
  const Lattice widest = make_lattice(width_px, height_px, 1, 1);
  const std::size_t count =
      static_cast<std::size_t>(widest.padded_width()) * static_cast<std::size_t>(height_px);
  Places places;
  places.bin = arena.take<std::uint16_t>(count);
  places.height_unit = arena.take<std::uint8_t>(count);
  places.blocks = arena.take<PlaceBlock>(count);
  places.unsorted = arena.take<PlaceBlock>(count);
  places.bin_begin = arena.take<std::int32_t>(kBinCount + 1);
  return places;
}

Status collect_places(const TiltField& field, const PlaceConfig& config, Places& places) noexcept {
  if (!is_valid(config)) return Status::kInvalidArgument;
  const Lattice lattice =
      make_lattice(field.rms_mm.width_px, field.rms_mm.height_px, config.stride_px, 1);
  const std::size_t place_count =
      static_cast<std::size_t>(lattice.padded_width()) * static_cast<std::size_t>(lattice.height);
  if (place_count > places.bin.size()) return Status::kShapeMismatch;
  places.width = lattice.width;
  places.height = lattice.height;
  places.padded_width = lattice.padded_width();
  Collector(field, config, places).run();
  return Status::kOk;
}

void set_heights(const TiltField& field, const SearchImages& images, Places& places) noexcept {
  const int stride_px = images.lattice.stride_px;
  for (int row = 0; row < places.height; ++row) {
    for (int column = 0; column < places.width; ++column) {
      if (!places.is_place(column, row)) continue;
      places.height_unit[places.index(column, row)] = height_unit(
          static_cast<double>(field.plane_mm(column * stride_px, row * stride_px)), images);
    }
  }
}

}  // namespace flatpose::search
