#pragma once
// The arithmetic of laying points on a plane, several points at a time; compiled once for every
// vector width, with the same bits.

#include <array>
#include <cstdint>

#include "flatpose/core/vector_path.hpp"
#include "flatpose/search/score.hpp"

namespace flatpose::search {

/// Room for all points of a sparse template, in whole vectors.
inline constexpr int kLaidCountMax = (kContourCountMax + kSurfaceCountMax + 7) / 8 * 8;

/// Relative to the anchor; contour before surface.
struct PointSet {
  template <class T>
  using Each = std::array<T, kLaidCountMax>;
  alignas(64) Each<double> x_mm{};
  Each<double> y_mm{};
  Each<double> z_mm{};
  Each<double> nx{};
  Each<double> ny{};
  Each<double> nz{};
  int contour_count = 0;
  int count = 0;
};

struct LaidPlane {
  std::array<double, 9> work_R_object;
  double slope_x = 0.0;
  double slope_y = 0.0;
  double cell_mm = 1.0;
  double unit_mm = 1.0;
};

/// In cells and units, relative to the place.
struct LaidPoints {
  alignas(64) PointSet::Each<std::int32_t> dx;
  PointSet::Each<std::int32_t> dy;
  PointSet::Each<std::int32_t> rise_unit;
  PointSet::Each<std::int32_t> octant;  ///< Of the contour.
};

using LayPoints = void (*)(const PointSet&, const LaidPlane&, LaidPoints&) noexcept;
[[nodiscard]] LayPoints lay_points_for(VectorPath path) noexcept;

}  // namespace flatpose::search
