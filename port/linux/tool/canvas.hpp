#pragma once
// Drawing by cairo, owned: a picture in memory that ends as the bytes of a PNG. For this folder's
// .cpp files: it pulls cairo in.

#include <cairo.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "port/linux/tool/relief.hpp"

namespace flatpose::tool {

class Canvas {
 public:
  /// Fails: std::bad_alloc.
  Canvas(int width_px, int height_px);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  [[nodiscard]] cairo_t* get() const noexcept { return cairo_; }
  [[nodiscard]] int width_px() const noexcept { return width_px_; }
  [[nodiscard]] int height_px() const noexcept { return height_px_; }

  void colour(const Colour& colour, double alpha = 1.0) noexcept;
  void box(double x, double y, double width, double height) noexcept;
  void rounded_box(double x, double y, double width, double height, double radius) noexcept;
  void line(double x0, double y0, double x1, double y1) noexcept;
  /// Draws 0xRRGGBB rows of `width_px` into the box.
  void picture(std::span<const std::uint32_t> xrgb, int width_px, int height_px, double x, double y,
               double box_width, double box_height);

  void font(double size_px, bool bold = false) noexcept;
  [[nodiscard]] double text_width(const std::string& text) const noexcept;
  /// The text's left end on its base line.
  void text(double x, double y, const std::string& text) noexcept;

  [[nodiscard]] std::vector<std::byte> png() const;

 private:
  int width_px_;
  int height_px_;
  cairo_surface_t* surface_;
  cairo_t* cairo_;
};

}  // namespace flatpose::tool
