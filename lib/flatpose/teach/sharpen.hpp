#pragma once
// Moves a template's contour to where the scans' own points say it is.

#include <array>

#include "flatpose/model/template.hpp"
#include "flatpose/refine/raw_contour.hpp"

namespace flatpose::teach {

/// Offsets of the contour measured in one or more scans.
class ContourMean {
 public:
  /// Measures every contour point, on the scan lines around it, in a scan where the part lies at
  /// the given pose.
  void add(const model::Template& part, const refine::RawScan& raw, const Pose& work_T_object,
           const refine::RawContourConfig& config) noexcept;

  /// Shifts the contour along its normals by the mean over scans and forgets them. Returns the rms
  /// of the shifts.
  double apply(model::Template& part) noexcept;

 private:
  std::array<double, model::kContourPointCountMax> sum_mm_{};
  std::array<double, model::kContourPointCountMax> spread_sum_mm_{};
  std::array<int, model::kContourPointCountMax> count_{};
};

}  // namespace flatpose::teach
