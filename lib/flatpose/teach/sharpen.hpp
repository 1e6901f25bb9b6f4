#pragma once
// Moves a template's contour to where the scans' own points say it is.

#include <array>

#include "flatpose/model/template.hpp"
#include "flatpose/refine/raw_contour.hpp"

namespace flatpose::teach {

/// Offsets of the contour measured in one or more scans.
class ContourMean {
 public:
  /// Measures every contour point in a scan where the part lies at the given pose.
  void add(const model::Template& part, const refine::RawScan& raw, const Pose& work_T_object,
           const refine::RawContourConfig& config) noexcept;

  /// Shifts the contour along its normals by the mean over scans, smoothed along the contour over
  /// `reach_mm`: the offset of a single scan line is off by up to half a pitch. Returns the rms of
  /// what was measured about it.
  double apply(double reach_mm, model::Template& part) noexcept;

 private:
  std::array<double, model::kContourPointCountMax> sum_mm_{};
  std::array<int, model::kContourPointCountMax> count_{};
};

}  // namespace flatpose::teach
