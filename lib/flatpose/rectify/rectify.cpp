#include "flatpose/rectify/rectify.hpp"

#include <algorithm>

namespace flatpose::rectify {

PaintConfig paint_config_for(const Survey& survey) noexcept {
  constexpr double kStepSigmas = 7.0;  // five sigma of the difference of two points
  constexpr double kGapPitches = 4.0;
  constexpr double kStepMin_mm = 0.3;
  PaintConfig config;
  if (survey.noise_sigma_mm > 0.0)
    config.jump_mm = std::max(kStepMin_mm, kStepSigmas * survey.noise_sigma_mm);
  const double pitch_mm = std::max(survey.pitch_along_row_mm, survey.pitch_along_column_mm);
  if (pitch_mm > 0.0) config.max_gap_mm = kGapPitches * pitch_mm;
  return config;
}

std::size_t required_bytes(Method method, int scan_width_px, int scan_height_px,
                           const Grid& grid) noexcept {
  return method == Method::kPaint ? paint_required_bytes(scan_width_px)
                                  : bucket_required_bytes(scan_width_px, scan_height_px, grid);
}

Status rectify(const RangeImageView& scan, const Pose& work_T_scan, const RectifyConfig& config,
               Arena& scratch, const HeightMap& out, const Budget& budget) noexcept {
  switch (config.method) {
    case Method::kPaint: return paint(scan, work_T_scan, config.paint, scratch, out, budget);
    case Method::kBucket: return bucket(scan, work_T_scan, scratch, out, budget);
  }
  return Status::kInvalidArgument;
}

}  // namespace flatpose::rectify
