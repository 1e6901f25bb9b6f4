#pragma once
// Rectification by bucketing (Ingberg 2015, section 2.8.1): every point goes to the cell it falls
// into, and the median of a cell's heights is its height. Robust where cells are much larger than
// the scan's pitch; finer cells leave holes, through which what lies below shows. A lone point
// counts.
//
// The points are put in the order of their cells by counting, so the cost is linear.

#include <cstddef>

#include "flatpose/core/arena.hpp"
#include "flatpose/core/budget.hpp"
#include "flatpose/core/status.hpp"
#include "flatpose/geometry/pose.hpp"
#include "flatpose/geometry/range_image.hpp"
#include "flatpose/rectify/height_map.hpp"

namespace flatpose::rectify {

/// Bytes of scratch that bucket() takes: about 12 a scan pixel and 4 a cell.
[[nodiscard]] std::size_t bucket_required_bytes(int scan_width_px, int scan_height_px,
                                                const Grid& grid) noexcept;

/// Sorts `scan` into `out`, whose grid and images the caller gives; they are cleared first.
/// The height is the median, of an even count the lower of the two in the middle, so that it is a
/// point's own; source_index is that point's pixel, of equal heights the first in scan order.
/// Units/frames: heights are z of the work frame.  Cost: linear in pixels and cells.
/// Memory: bucket_required_bytes() of scratch, given back.  Fails: kInvalidArgument, kNotFinite,
/// kTooLarge, kShapeMismatch, kOutOfMemory; `out` is then as it was.  Thread: reentrant.
[[nodiscard]] Status bucket(const RangeImageView& scan, const Pose& work_T_scan, Arena& scratch,
                            const HeightMap& out, const Budget& budget = callers_thread) noexcept;

}  // namespace flatpose::rectify
