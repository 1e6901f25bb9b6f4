#include "flatpose/search/block_search.hpp"

#include <algorithm>

namespace flatpose::search {

void search_block_portable(const BlockJob& job) noexcept;
void search_block_avx2(const BlockJob& job) noexcept;
void search_block_avx512(const BlockJob& job) noexcept;
void bound_nodes_portable(const NodeJob& job) noexcept;
void bound_nodes_avx2(const NodeJob& job) noexcept;
void bound_nodes_avx512(const NodeJob& job) noexcept;

OffsetTable::OffsetTable(const Lattice& lattice) noexcept {
  for (int d = -lattice.reach_px(); d <= lattice.reach_px(); ++d) {
    of_columns_[d + kReachMax_px] = lattice.offset_bytes(d, 0);
    of_rows_[d + kReachMax_px] = lattice.offset_bytes(0, d);
  }
}

ShiftedTemplate shifted(const ProjectedTemplate& projected, const SearchImages& images) noexcept {
  ShiftedTemplate t;
  shift(projected, images, OffsetTable(images.lattice), t);
  return t;
}

void shift(const ProjectedTemplate& projected, const SearchImages& images,
           const OffsetTable& offsets, ShiftedTemplate& out) noexcept {
  const auto image_bytes = static_cast<std::int32_t>(images.lattice.image_bytes());
  const std::int32_t surface_image = SearchImages::kSurfaceImage * image_bytes;
  out.contour_count = projected.contour_count;
  out.surface_count = projected.surface_count;
  out.edge_factor_q8 = projected.edge_factor_q8;
  RiseRange rises{kHeightUnitMax, -kHeightUnitMax};
  const auto include = [&rises](std::int32_t rise_unit) {
    rises.low_unit = std::min(rises.low_unit, rise_unit);
    rises.high_unit = std::max(rises.high_unit, rise_unit);
  };
  for (int i = 0; i < projected.contour_count; ++i) {
    const ProjectedTemplate::Contour& from = projected.contour[i];
    const std::int32_t shift = offsets.offset_bytes(from.dx, from.dy);
    const std::int32_t octant = images.config.use_directions ? from.octant : 0;
    out.contour[i].offset_bytes = octant * image_bytes + shift;
    out.contour[i].second_offset_bytes = surface_image + shift;
    out.contour[i].rise_row_bytes = rise_row_bytes(from.rise_unit);
    include(bounded_rise(from.rise_unit));
  }
  for (int i = 0; i < projected.surface_count; ++i) {
    const ProjectedTemplate::Surface& from = projected.surface[i];
    const std::int32_t shift = offsets.offset_bytes(from.dx, from.dy);
    out.surface[i].offset_bytes = surface_image + shift;
    out.surface[i].second_offset_bytes = surface_image + image_bytes + shift;
    if (images.config.use_height) {
      out.surface[i].rise_row_bytes = rise_row_bytes(from.rise_unit);
      include(bounded_rise(from.rise_unit));
    } else {
      out.surface[i].low = static_cast<std::uint8_t>(from.normal_x_unit);
      out.surface[i].high = static_cast<std::uint8_t>(from.normal_y_unit);
    }
  }
  out.rises = rises;
}

RiseRange rise_range(std::span<const ShiftedTemplate> angles) noexcept {
  RiseRange range{kHeightUnitMax, -kHeightUnitMax};
  for (const ShiftedTemplate& t : angles) {
    range.low_unit = std::min(range.low_unit, t.rises.low_unit);
    range.high_unit = std::max(range.high_unit, t.rises.high_unit);
  }
  return range.low_unit <= range.high_unit ? range : RiseRange{};
}

SearchBlock search_block_for(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, search_block_portable, search_block_avx2, search_block_avx512);
}

BoundNodes bound_nodes_for(VectorPath path) noexcept {
  return FLATPOSE_FORM_FOR(path, bound_nodes_portable, bound_nodes_avx2, bound_nodes_avx512);
}

}  // namespace flatpose::search
