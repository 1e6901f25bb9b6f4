#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flatpose/image/chamfer.hpp"
#include "flatpose/search/tilt_field.hpp"
#include "flatpose/teach/clouds.hpp"
#include "flatpose/teach/spread_order.hpp"

namespace flatpose::teach {
namespace {

constexpr int kFitRadius_px = 2;
constexpr int kSampleCountMin = 8;
constexpr double kParallel = 0.08;  // 4.6 degrees

std::size_t cell_count_of(const rectify::Grid& grid) noexcept {
  return static_cast<std::size_t>(grid.width_px) * static_cast<std::size_t>(grid.height_px);
}

// Distance of every cell to the nearest one that is no free surface: off the part, missing, or an
// edge.
Status measure_clearance(const scene::Scene& scene, const PartMask& mask,
                         ImageView<std::uint8_t> blocked,
                         ImageView<std::uint16_t> distance_third_px) noexcept {
  for (int y = 0; y < blocked.height_px; ++y) {
    for (int x = 0; x < blocked.width_px; ++x) {
      const bool free = mask.is_part(x, y) != 0 && scene.edge_kind(x, y) == 0;
      blocked(x, y) = free ? 0 : 1;
    }
  }
  return image::chamfer_distance(blocked, distance_third_px);
}

}  // namespace

void reserve_cloud_scratch(Arena& arena, const rectify::Grid& grid) noexcept {
  (void)arena.take<SurfaceSample>(kSampleCountMax);
  (void)arena.take<double>(kSampleCountMax);
  (void)search::take_tilt_field(arena, grid.width_px, grid.height_px);
  (void)arena.take<std::uint8_t>(cell_count_of(grid));
  (void)arena.take<std::uint16_t>(cell_count_of(grid));
  for (int k = 0; k < 3; ++k) (void)arena.take<double>(cell_count_of(grid));
  // The contour's scratch is smaller than what the surface's fit has given back by then.
}

Status sample_surface(const scene::Scene& scene, const PartMask& mask, double noise_mm,
                      Arena& arena, SurfaceSamples& out) noexcept {
  const rectify::Grid& grid = scene.map.grid;
  out.samples = arena.take<SurfaceSample>(kSampleCountMax);
  out.clearance_mm = arena.take<double>(kSampleCountMax);
  const ArenaScope scope(arena);
  search::TiltField tilt = search::take_tilt_field(arena, grid.width_px, grid.height_px);
  const auto blocked = arena.take_image<std::uint8_t>(grid.width_px, grid.height_px);
  const auto distance_third_px = arena.take_image<std::uint16_t>(grid.width_px, grid.height_px);
  if (arena.failed()) return Status::kOutOfMemory;
  if (const Status s =
          search::fit_tilt_field(scene.filled_mm, grid.cell_mm, kFitRadius_px, arena, tilt);
      s != Status::kOk) {
    return s;
  }
  if (const Status s = measure_clearance(scene, mask, blocked, distance_third_px); s != Status::kOk)
    return s;

  // The widest stride that still gives enough samples, so that they lie evenly.
  const double per_sample = std::sqrt(static_cast<double>(mask.cell_count) / kSampleCountMax);
  const int stride_px = std::max(1, static_cast<int>(std::ceil(per_sample)));
  constexpr int kClearanceMin_third_px =
      3 * (kFitRadius_px + 1);  // the fit's window touches no edge
  const double rms_max_mm = 3.0 * noise_mm + 0.05 * grid.cell_mm;
  out.stride_mm = stride_px * grid.cell_mm;
  out.count = 0;
  for (int y = 0; y < grid.height_px; y += stride_px) {
    for (int x = 0; x < grid.width_px; x += stride_px) {
      if (distance_third_px(x, y) < kClearanceMin_third_px || scene.missing(x, y) != 0) continue;
      if (!(tilt.rms_mm(x, y) <= rms_max_mm) || out.count == kSampleCountMax) continue;
      out.samples[out.count] = {grid.x_of(x), grid.y_of(y), tilt.plane_mm(x, y), tilt.slope_x(x, y),
                                tilt.slope_y(x, y)};
      out.clearance_mm[out.count] = distance_third_px(x, y) * grid.cell_mm / 3.0;
      ++out.count;
    }
  }
  return out.count >= kSampleCountMin ? Status::kOk : Status::kTooFewPoints;
}

// Every cell of the part, its margin too, goes to the point nearest to it.
void weigh_by_area(const SurfaceSamples& samples, const PartMask& mask, const rectify::Grid& grid,
                   std::span<const int> candidates, std::span<const int> order,
                   model::Template& part) noexcept {
  const double per_cell = std::sqrt(static_cast<double>(mask.cell_count) / kSampleCountMax);
  const int stride_px = std::max(1, static_cast<int>(std::ceil(per_cell)));
  std::array<int, model::kSurfacePointCountMax> cell_count{};
  int sum = 0;
  for (int y = 0; y < grid.height_px; y += stride_px) {
    for (int x = 0; x < grid.width_px; x += stride_px) {
      if (mask.is_part(x, y) == 0) continue;
      int nearest = 0;
      double nearest2 = std::numeric_limits<double>::infinity();
      for (int k = 0; k < part.surface_count; ++k) {
        const SurfaceSample& p = samples.samples[candidates[order[k]]];
        const double dx = p.x_mm - grid.x_of(x);
        const double dy = p.y_mm - grid.y_of(y);
        const double d2 = dx * dx + dy * dy;
        if (d2 >= nearest2) continue;
        nearest2 = d2;
        nearest = k;
      }
      ++cell_count[nearest];
      ++sum;
    }
  }
  for (int k = 0; k < part.surface_count && sum > 0; ++k) {
    part.surface[k].weight =
        static_cast<float>(static_cast<double>(cell_count[k]) * part.surface_count / sum);
  }
}

Status build_surface_cloud(const SurfaceSamples& samples, const PartMask& mask,
                           const rectify::Grid& grid, const Pose& work_T_object, double margin_mm,
                           Arena& scratch, model::Template& part) noexcept {
  const ArenaScope scope(scratch);
  const std::span<int> candidates = scratch.take<int>(kSampleCountMax);
  const std::span<double> nearest = scratch.take<double>(kSampleCountMax);
  const std::span<int> order = scratch.take<int>(model::kSurfacePointCountMax);
  if (scratch.failed()) return Status::kOutOfMemory;
  int candidate_count = 0;
  for (int i = 0; i < samples.count; ++i) {
    if (samples.clearance_mm[i] >= margin_mm) candidates[candidate_count++] = i;
  }
  if (candidate_count < kSampleCountMin) {  // a part of narrow webs: take what there is
    candidate_count = samples.count;
    for (int i = 0; i < samples.count; ++i) candidates[i] = i;
  }
  const auto distance = [&](int a, int b) {
    const SurfaceSample& p = samples.samples[candidates[a]];
    const SurfaceSample& q = samples.samples[candidates[b]];
    return (p.x_mm - q.x_mm) * (p.x_mm - q.x_mm) + (p.y_mm - q.y_mm) * (p.y_mm - q.y_mm);
  };
  // A border mirrors the points: the nearest of the other side is twice as far as the border.
  const auto border = [&](int i) {
    const double mirrored_mm = 2.0 * samples.clearance_mm[candidates[i]];
    return mirrored_mm * mirrored_mm;
  };
  part.surface_count = spread_order_within(candidate_count, border, distance, nearest, order);
  const Pose object_T_work = work_T_object.inverse();
  for (int k = 0; k < part.surface_count; ++k) {
    const SurfaceSample& s = samples.samples[candidates[order[k]]];
    const Vec3 p = object_T_work * Vec3{s.x_mm, s.y_mm, s.z_mm};
    Vec3 n = object_T_work.rotation * normalized({-s.slope_x, -s.slope_y, 1.0});
    // What is nearly parallel to the main plane is: the rest of its slope is noise.
    if (n.x * n.x + n.y * n.y < kParallel * kParallel) n = {0, 0, 1};
    part.surface[k] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z),
                       static_cast<float>(n.x), static_cast<float>(n.y)};
  }
  weigh_by_area(samples, mask, grid, candidates, order, part);
  return Status::kOk;
}

Status place_anchors(const SurfaceSamples& samples, const Pose& work_T_object, double tolerance_mm,
                     model::Template& part) noexcept {
  const Pose object_T_work = work_T_object.inverse();
  const auto object_of = [&](int i) {
    const SurfaceSample& s = samples.samples[i];
    return object_T_work * Vec3{s.x_mm, s.y_mm, s.z_mm};
  };
  // The first is the widest flat disc. A fallback lies as far from those before it as a disc of
  // some width can, or it would be covered with them.
  constexpr double kFallbackShare = 0.6;
  constexpr double kFallbackCells = 10.0;  // wide enough to read a tilt from
  constexpr double kApartShare = 0.7;
  const auto worth = [&](int i) {
    const Vec3 p = object_of(i);
    const double clearance_mm = samples.clearance_mm[i];
    if (std::fabs(p.z) > tolerance_mm) return 0.0;
    if (part.anchor_count == 0) return clearance_mm;
    const double first_mm = part.anchors[0].clearance_mm;
    if (clearance_mm < std::min(kFallbackShare * first_mm, kFallbackCells * part.cell_mm))
      return 0.0;
    double apart_mm = std::numeric_limits<double>::max();
    for (int k = 0; k < part.anchor_count; ++k) {
      const double dx = p.x - part.anchors[k].x_mm;
      const double dy = p.y - part.anchors[k].y_mm;
      apart_mm = std::min(apart_mm, std::sqrt(dx * dx + dy * dy));
    }
    // What lies within a disc already placed is no other place.
    return apart_mm > kApartShare * first_mm ? apart_mm + clearance_mm : 0.0;
  };
  part.anchor_count = 0;
  for (int k = 0; k < model::kAnchorCountMax; ++k) {
    int best = -1;
    double best_worth = samples.stride_mm;
    for (int i = 0; i < samples.count; ++i) {
      const double w = worth(i);
      if (w > best_worth) {
        best = i;
        best_worth = w;
      }
    }
    if (best < 0) break;
    const Vec3 p = object_of(best);
    part.anchors[part.anchor_count++] = {static_cast<float>(p.x), static_cast<float>(p.y),
                                         static_cast<float>(samples.clearance_mm[best])};
  }
  return part.anchor_count > 0 ? Status::kOk : Status::kTooFewPoints;
}

}  // namespace flatpose::teach
