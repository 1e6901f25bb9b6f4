#include "flatpose/search/search_images.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flatpose/image/direction_channels.hpp"
#include "flatpose/image/fill.hpp"
#include "flatpose/image/glance.hpp"
#include "flatpose/image/normals.hpp"
#include "flatpose/image/pyramid.hpp"

namespace flatpose::search {
namespace {

bool is_valid(const SearchImagesConfig& config) noexcept {
  return config.stride_px >= 1 && config.stride_px <= kStrideMax_px &&
         config.height_tolerance_mm > 0.0 && config.normal_tolerance_rad > 0.0 &&
         (config.node_side == 0 || config.node_side == 2 || config.node_side == 4) &&
         config.node_slack >= 0 && config.node_slack <= kNodeSlackMax &&
         (config.node_slack == 0 || config.stride_px == 1);
}

std::size_t image_bytes_max(int width_px, int height_px) noexcept {
  std::size_t most = 0;
  for (int stride_px = 1; stride_px <= kStrideMax_px; ++stride_px) {
    most = std::max(most, make_lattice(width_px, height_px, stride_px, kReachMax_px).image_bytes());
  }
  return most;
}

// Fine enough for the tolerance, coarse enough for the range to fit a byte.
void choose_units(const HeightRange& range, SearchImages& images) noexcept {
  const double tolerance_mm = images.config.height_tolerance_mm;
  const double low_mm = range.low_mm - 2.0 * tolerance_mm;
  const double span_mm = range.high_mm + 2.0 * tolerance_mm - low_mm;
  images.base_mm = low_mm;
  images.height_unit_mm = std::max(tolerance_mm / kSurfaceCostMax, span_mm / kHeightUnitMax);
  images.surface_cap = kSurfaceCostMax;
  images.surface_weight = 1;
  if (!images.config.use_height) return;
  images.surface_cap = std::clamp(
      static_cast<std::int32_t>(tolerance_mm / images.height_unit_mm + 0.5), 2, kSurfaceCostMax);
  images.surface_weight = kSurfaceCostMax / images.surface_cap;
}

std::uint8_t* image_at(const SearchImages& images, int index) noexcept {
  return images.bytes.data() + static_cast<std::size_t>(index) * images.lattice.image_bytes();
}

// height_unit() of a row.
void write_units(const float* __restrict height_mm, const SearchImages& images, int width_px,
                 std::uint8_t* __restrict unit) noexcept {
  const double base_mm = images.base_mm;
  const double height_unit_mm = images.height_unit_mm;
  for (int x = 0; x < width_px; ++x) {
    const double value = (static_cast<double>(height_mm[x]) - base_mm) / height_unit_mm + 0.5;
    const double bounded = value < kHeightUnitMax ? value : 1.0 * kHeightUnitMax;
    unit[x] = static_cast<std::uint8_t>(static_cast<int>(bounded > 0.0 ? bounded : 0.0));
  }
}

Status spread_heights(const SearchImages& images, Arena& scratch) noexcept {
  const ArenaScope scope(scratch);
  const auto unit = scratch.take_image<std::uint8_t>(images.grid.width_px, images.grid.height_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  for (int y = 0; y < unit.height_px; ++y)
    write_units(images.filled_mm.row(y), images, unit.width_px, unit.row(y));
  spread(unit, images.lattice, kOutsideUnit, image_at(images, SearchImages::kSurfaceImage));
  return Status::kOk;
}

struct Normals {
  ImageView<float> x;
  ImageView<float> y;
  ImageView<std::uint8_t> unit;
};

Normals take_normals(Arena& arena, int width_px, int height_px) noexcept {
  return {arena.take_image<float>(width_px, height_px),
          arena.take_image<float>(width_px, height_px),
          arena.take_image<std::uint8_t>(width_px, height_px)};
}

Status spread_normals(const SearchImages& images, Arena& scratch) noexcept {
  const ArenaScope scope(scratch);
  const int width_px = images.grid.width_px;
  const int height_px = images.grid.height_px;
  const Normals normals = take_normals(scratch, width_px, height_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  const Status s = image::normal_map(images.filled_mm, images.grid.cell_mm, normals.x, normals.y);
  if (s != Status::kOk) return s;
  for (int axis = 0; axis < 2; ++axis) {
    const ImageView<float> component = axis == 0 ? normals.x : normals.y;
    for (int y = 0; y < height_px; ++y) {
      for (int x = 0; x < width_px; ++x) {
        normals.unit(x, y) = static_cast<std::uint8_t>(normal_unit(component(x, y), images.config));
      }
    }
    spread(normals.unit, images.lattice, kOutsideUnit,
           image_at(images, SearchImages::kSurfaceImage + axis));
  }
  return Status::kOk;
}

// Every direction's costs become those of any.
void forget_directions(const image::OctantImage& costs) noexcept {
  for (int y = 0; y < costs.cells.height_px; ++y) {
    image::OctantCell* row = costs.cells.row(y);
    for (int x = 0; x < costs.cells.width_px; ++x)
      row[x].of.fill(*std::min_element(row[x].of.begin(), row[x].of.end()));
  }
}

// Turns eight numbers of eight bytes over: byte k of number i becomes byte i of number k.
void transpose(std::array<std::uint64_t, 8>& rows) noexcept {
  const auto exchange = [&rows](std::size_t distance, std::uint64_t low) {
    const auto shift = 8 * distance;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if ((i & distance) != 0) continue;
      const std::uint64_t upper = rows[i], lower = rows[i + distance];
      rows[i] = (upper & low) | (lower & low) << shift;
      rows[i + distance] = (upper >> shift & low) | (lower & ~low);
    }
  };
  exchange(4, 0x00000000FFFFFFFFU);
  exchange(2, 0x0000FFFF0000FFFFU);
  exchange(1, 0x00FF00FF00FF00FFU);
}

// The bytes of a row of one phase, for the images of the first `image_count` directions.
void spread_row(const image::OctantCell* source, int stride, int count, int image_count,
                std::size_t image_bytes, std::uint8_t* target) noexcept {
  constexpr int kSome = 8;
  int i = 0;
  for (; i + kSome <= count; i += kSome) {
    std::array<std::uint64_t, kSome> some{};
    for (int n = 0; n < kSome; ++n)
      some[static_cast<std::size_t>(n)] = image::eight_from(source[(i + n) * stride].of.data());
    transpose(some);
    for (int k = 0; k < image_count; ++k) {
      image::write_eight(some[static_cast<std::size_t>(k)],
                         target + static_cast<std::size_t>(k) * image_bytes + i);
    }
  }
  for (; i < count; ++i) {
    for (int k = 0; k < image_count; ++k)
      target[static_cast<std::size_t>(k) * image_bytes + static_cast<std::size_t>(i)] =
          source[i * stride].of[static_cast<std::size_t>(k)];
  }
}

// As spread(), for the images of the first `image_count` directions.
void spread_directions(const image::OctantImage& costs, int image_count,
                       const SearchImages& images) noexcept {
  const Lattice& lattice = images.lattice;
  const int s = lattice.stride_px;
  for (int k = 0; k < image_count; ++k)
    fill_margins(costs.cells.width_px, costs.cells.height_px, lattice, kEdgeCostUnknown,
                 image_at(images, k));
  for (int y = 0; y < costs.cells.height_px; ++y) {
    for (int phase_x = 0; phase_x < s; ++phase_x) {
      const auto phase = static_cast<std::size_t>(y % s * s + phase_x);
      spread_row(costs.cells.row(y) + phase_x, s, (costs.cells.width_px - phase_x + s - 1) / s,
                 image_count, lattice.image_bytes(),
                 image_at(images, 0) + phase * lattice.phase_bytes() + lattice.byte_of(0, y / s));
    }
  }
}

}  // namespace

std::int16_t normal_unit(double component, const SearchImagesConfig& config) noexcept {
  const double unit = config.normal_tolerance_rad / kSurfaceCostMax;
  const double value = std::floor(component / unit + 0.5) + kNormalZero;
  return static_cast<std::int16_t>(std::clamp(value, 0.0, 2.0 * kNormalZero));
}

std::uint8_t height_unit(double height_mm, const SearchImages& images) noexcept {
  // The conversion rounds down what is not negative: no call of floor().
  const double value = (height_mm - images.base_mm) / images.height_unit_mm + 0.5;
  return static_cast<std::uint8_t>(std::clamp(value, 0.0, 1.0 * kHeightUnitMax));
}

SearchImages take_search_images(Arena& arena, const rectify::Grid& fine, bool with_nodes) noexcept {
  SearchImages images;
  images.grid = image::halved(fine);
  const int width_px = images.grid.width_px;
  const int height_px = images.grid.height_px;
  images.filled_mm = arena.take_image<float>(width_px, height_px);
  images.bytes =
      arena.take<std::uint8_t>(SearchImages::kImageCountMax * image_bytes_max(width_px, height_px));
  if (with_nodes) images.nodes = take_node_images(arena, width_px, height_px);
  return images;
}

void reserve_edge_cost_scratch(Arena& arena, const rectify::Grid& coarse) noexcept {
  (void)arena.take_image<image::OctantCell>(coarse.width_px, coarse.height_px);
}

void reserve_surface_scratch(Arena& arena, const rectify::Grid& coarse) noexcept {
  const int width_px = coarse.width_px;
  const int height_px = coarse.height_px;
  {
    const ArenaScope scope(arena);  // halve_heights
    (void)arena.take_image<std::uint8_t>(width_px, height_px);
    image::reserve_fill_scratch(arena, width_px);
  }
  (void)take_normals(arena, width_px, height_px);  // and fewer for the heights
}

void reserve_image_scratch(Arena& arena, const rectify::Grid& coarse) noexcept {
  {
    const ArenaScope scope(arena);
    reserve_edge_cost_scratch(arena, coarse);
  }
  reserve_surface_scratch(arena, coarse);
}

Status halve_heights(const scene::Scene& scene, double jump_mm, Arena& scratch,
                     SearchImages& images) noexcept {
  const ArenaScope scope(scratch);
  const auto missing =
      scratch.take_image<std::uint8_t>(images.grid.width_px, images.grid.height_px);
  if (scratch.failed()) return Status::kOutOfMemory;
  const Status s = image::halve(scene.map.height_mm, static_cast<float>(jump_mm), images.filled_mm,
                                scene.vector_path);
  return s == Status::kOk ? image::fill_missing(images.filled_mm, images.filled_mm, missing,
                                                scratch, scene.vector_path)
                          : s;
}

Status begin_search_images(const SearchImagesConfig& config, SearchImages& images) noexcept {
  if (!is_valid(config)) return Status::kInvalidArgument;
  if (config.node_side > 0 && images.nodes.bytes.empty()) return Status::kInvalidArgument;
  images.config = config;
  images.lattice =
      make_lattice(images.grid.width_px, images.grid.height_px, config.stride_px, config.reach_px);
  return Status::kOk;
}

Status write_surface(const HeightRange& range, Arena& scratch, SearchImages& images) noexcept {
  choose_units(range, images);
  return images.config.use_height ? spread_heights(images, scratch)
                                  : spread_normals(images, scratch);
}

// The scene's edges at the coarse level: found where they are sharpest, drawn where they are
// needed.
Status write_edge_costs(const scene::Scene& scene, Arena& scratch, const SearchImages& images,
                        const Budget& budget) noexcept {
  const ArenaScope scope(scratch);
  const image::OctantImage costs{
      scratch.take_image<image::OctantCell>(images.grid.width_px, images.grid.height_px)};
  if (scratch.failed()) return Status::kOutOfMemory;
  image::ChannelConfig config;
  config.edge_cells = 2;
  config.distance_max_third_px = kEdgeCostMax;
  if (const Status s = image::edge_distances(scene.edges, config, costs, scene.vector_path, budget);
      s != Status::kOk)
    return s;
  if (!images.config.use_directions) forget_directions(costs);
  spread_directions(costs, images.config.use_directions ? image::kOctantCount : 1, images);
  return Status::kOk;
}

Status build_search_images(const scene::Scene& scene, const SearchImagesConfig& config,
                           const HeightRange& range, Arena& scratch,
                           SearchImages& images) noexcept {
  Status s = begin_search_images(config, images);
  if (s == Status::kOk) s = write_surface(range, scratch, images);
  if (s == Status::kOk) s = write_edge_costs(scene, scratch, images);
  if (s == Status::kOk) build_node_images(images);
  return s;
}

}  // namespace flatpose::search
