#pragma once
// The loops of the tilt field over the places of a row. Their text is compiled once for every
// vector width; all give the same bits.

#include <cstddef>

#include "flatpose/core/vector_path.hpp"

namespace flatpose::search {

inline constexpr int kPlacesAtOnceMax = 8;  ///< So many more can be read and written beyond a row.

/// How the places of a row see a map.
struct TiltWindow {
  int radius_px = 1;
  int stride_px = 1;
  int place_count = 0;
  std::size_t row_doubles = 0;  ///< From a row of scratch to the next.
};

/// Sums over the window's part of one row, for each place.
struct TiltRowSums {
  double* z;
  double* iz;
  double* zz;
};

/// What the planes of a row of places come to, mm and cells.
struct TiltRowFits {
  double* a;  ///< Slopes, mm a cell.
  double* b;
  double* c_mm;
  double* rms_mm;
};

struct TiltKernels {
  /// `heights` points to place 0 in the first of stride_px rows: heights at one offset from all
  /// places are neighbours.
  void (*sum_row)(const TiltWindow& window, const double* heights, const TiltRowSums& out) noexcept;
  /// `rows` holds the sums of the window's 2 radius + 1 rows, from above to below.
  void (*fit_row)(const TiltWindow& window, const TiltRowSums* rows,
                  const TiltRowFits& out) noexcept;
};

/// The loops for a path; the portable ones where this build has no other.
[[nodiscard]] const TiltKernels& tilt_kernels(VectorPath path) noexcept;

/// Those that exist: reached through tilt_kernels() alone.
extern const TiltKernels kPortableTiltKernels;
extern const TiltKernels kAvx2TiltKernels;
extern const TiltKernels kAvx512TiltKernels;

}  // namespace flatpose::search
