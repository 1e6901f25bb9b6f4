#pragma once
// What an interpolation yields at a place, and how it becomes a number of the caller's kind.
//
// An interpolation f(x, y) is computed once in doubles together with its gradient; a number that
// carries first derivatives (a dual number) gets them by the chain rule,
//   f(x) + f_x (x - x0) + f_y (y - y0),  (x0, y0) the plain value of (x, y),
// which for plain doubles is f(x). This is cheaper than 16 products of dual numbers and exact for
// first derivatives; a type of higher order would lose its second ones.

#include <type_traits>

namespace flatpose::image {

/// The plain value of a coordinate. Number types of other rooms bring their own overload beside
/// them.
[[nodiscard]] inline double scalar_part(double x) noexcept { return x; }

struct Sample {
  double value = 0.0;
  double slope_x = 0.0;  ///< d value / d column.
  double slope_y = 0.0;  ///< d value / d row.
};

/// `sample`, taken at (x, y), as a T with T's derivatives.
template <class T>
[[nodiscard]] inline T lift(const Sample& sample, const T& x, const T& y) noexcept {
  if constexpr (std::is_same_v<T, double>) return sample.value;
  return sample.value + sample.slope_x * (x - scalar_part(x)) +
         sample.slope_y * (y - scalar_part(y));
}

/// A coordinate held inside [0, size_px - 1], and whether it was inside. NaN becomes 0.
struct ClampedCoordinate {
  double at = 0.0;
  bool inside = false;
};
[[nodiscard]] inline ClampedCoordinate clamp_coordinate(double x, int size_px) noexcept {
  const double last = size_px - 1;
  if (!(x >= 0.0)) return {0.0, false};
  if (x > last) return {last, false};
  return {x, true};
}

}  // namespace flatpose::image
