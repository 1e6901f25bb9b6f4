#pragma once
// A view of an image in memory that somebody else owns: (column, row), row-major.

#include <cassert>
#include <cstddef>
#include <type_traits>

namespace flatpose {

template <class T>
struct ImageView {
  T* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::ptrdiff_t stride_px = 0;  ///< Pixels from one row to the next.

  T* row(int y) const noexcept { return data + y * stride_px; }
  T& operator()(int x, int y) const noexcept {
    assert(contains(x, y));
    return data[y * stride_px + x];
  }
  [[nodiscard]] bool contains(int x, int y) const noexcept {
    return x >= 0 && y >= 0 && x < width_px && y < height_px;
  }
  [[nodiscard]] bool empty() const noexcept { return width_px <= 0 || height_px <= 0; }

  operator ImageView<const T>() const noexcept  // NOLINT: a view of T is a view of const T
      requires(!std::is_const_v<T>) {
    return {data, width_px, height_px, stride_px};
  }
};

template <class A, class B>
[[nodiscard]] bool same_shape(const ImageView<A>& a, const ImageView<B>& b) noexcept {
  return a.width_px == b.width_px && a.height_px == b.height_px;
}

}  // namespace flatpose
