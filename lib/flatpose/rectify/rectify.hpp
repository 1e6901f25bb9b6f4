#pragma once
// Range image -> orthographic height map: the one entry to both methods of Ingberg 2015, section
// 2.8.1. Choose the grid with survey.hpp; for several resolutions call with several grids.

#include <cstddef>

#include "flatpose/rectify/bucket.hpp"
#include "flatpose/rectify/paint.hpp"
#include "flatpose/rectify/survey.hpp"

namespace flatpose::rectify {

enum class Method {
  kPaint,   ///< Triangles: no holes in a connected surface. The default.
  kBucket,  ///< Medians: robust in cells of many points.
};

struct RectifyConfig {
  Method method = Method::kPaint;
  PaintConfig paint;  ///< Read by kPaint alone.
};

/// Painting's thresholds from the scan itself: steps of seven sigma of its noise and gaps of four
/// pitches belong to a surface. Defaults stand in for what the survey could not measure.
[[nodiscard]] PaintConfig paint_config_for(const Survey& survey) noexcept;

/// Bytes of scratch that rectify() takes.
[[nodiscard]] std::size_t required_bytes(Method method, int scan_width_px, int scan_height_px,
                                         const Grid& grid) noexcept;

/// Rectifies `scan` into `out` by the method of `config`: see paint() and bucket().
[[nodiscard]] Status rectify(const RangeImageView& scan, const Pose& work_T_scan,
                             const RectifyConfig& config, Arena& scratch, const HeightMap& out,
                             const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::rectify
