#pragma once
// An image that owns its pixels, for tests.

#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "flatpose/core/image_view.hpp"

namespace flatpose::image {

inline constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

template <class T>
class Image {
 public:
  Image(int width_px, int height_px, T value = T{})
      : width_px_(width_px),
        height_px_(height_px),
        pixels_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), value) {}

  template <class Function>
  static Image of(int width_px, int height_px, const Function& value_at) {
    Image image(width_px, height_px);
    for (int y = 0; y < height_px; ++y) {
      for (int x = 0; x < width_px; ++x) image(x, y) = static_cast<T>(value_at(x, y));
    }
    return image;
  }

  [[nodiscard]] int width() const { return width_px_; }
  [[nodiscard]] int height() const { return height_px_; }
  T& operator()(int x, int y) { return pixels_[static_cast<std::size_t>(y * width_px_ + x)]; }
  const T& operator()(int x, int y) const {
    return pixels_[static_cast<std::size_t>(y * width_px_ + x)];
  }
  T* data() { return pixels_.data(); }
  ImageView<T> view() { return {pixels_.data(), width_px_, height_px_, width_px_}; }
  ImageView<const T> view() const { return {pixels_.data(), width_px_, height_px_, width_px_}; }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  int width_px_;
  int height_px_;
  std::vector<T> pixels_;
};

inline Image<float> random_image(int width_px, int height_px, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(-10.0F, 10.0F);
  return Image<float>::of(width_px, height_px, [&](int, int) { return value(generator); });
}

}  // namespace flatpose::image
