#pragma once
// The scan's own points under a part at a pose, placed in the part's frame: what the last step
// fits z and tilt to.

#include <cstddef>
#include <span>

#include "flatpose/core/arena.hpp"
#include "flatpose/model/template.hpp"
#include "flatpose/refine/raw_scan.hpp"

namespace flatpose::refine {

struct Footprint {
  static constexpr int kPatchRadiusMax_px = 3;
  static constexpr int kPatchSideMax_px = 2 * kPatchRadiusMax_px + 1;
  static constexpr int kLaneCount = 8;
  static constexpr std::size_t kCapacity =
      model::kSurfacePointCountMax * kPatchSideMax_px * kPatchSideMax_px;
  static_assert(kCapacity % kLaneCount == 0);

  /// How far each point lies off the part's surface, along z.
  std::span<float> above_mm;
  std::span<float> x_mm;
  std::span<float> y_mm;
  int count = 0;
};

[[nodiscard]] Footprint take_footprint(Arena& arena) noexcept;

/// The points of square patches around the surface points, as large as these are apart, so that
/// nearly every point is there about once; `thinned`: of every second row and column only.
/// Shape: filled up to a multiple of kLaneCount with points that are far off the surface.
/// Cost: some 5 ns a point.
void gather(const model::Template& part, const RawScan& raw, const Pose& work_T_object,
            bool thinned, Footprint& footprint) noexcept;

}  // namespace flatpose::refine
