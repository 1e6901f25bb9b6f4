#include "port/linux/tool/canvas.hpp"

#include <algorithm>
#include <new>
#include <numbers>

namespace flatpose::tool {
namespace {

constexpr const char* kFont = "DejaVu Sans";

cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) {
  auto& bytes = *static_cast<std::vector<std::byte>*>(closure);
  try {
    const auto* first = reinterpret_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + length);
  } catch (const std::bad_alloc&) {  // must not fly through C
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Canvas::Canvas(int width_px, int height_px)
    : width_px_(width_px),
      height_px_(height_px),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px)),
      cairo_(cairo_create(surface_)) {
  if (cairo_status(cairo_) == CAIRO_STATUS_SUCCESS) return;
  cairo_destroy(cairo_);
  cairo_surface_destroy(surface_);
  throw std::bad_alloc();
}

Canvas::~Canvas() {
  cairo_destroy(cairo_);
  cairo_surface_destroy(surface_);
}

void Canvas::colour(const Colour& c, double alpha) noexcept {
  cairo_set_source_rgba(cairo_, c.red, c.green, c.blue, alpha);
}

void Canvas::box(double x, double y, double width, double height) noexcept {
  cairo_rectangle(cairo_, x, y, width, height);
  cairo_fill(cairo_);
}

void Canvas::rounded_box(double x, double y, double width, double height, double r) noexcept {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, x + width - r, y + r, r, -kQuarter, 0.0);
  cairo_arc(cairo_, x + width - r, y + height - r, r, 0.0, kQuarter);
  cairo_arc(cairo_, x + r, y + height - r, r, kQuarter, 2.0 * kQuarter);
  cairo_arc(cairo_, x + r, y + r, r, 2.0 * kQuarter, 3.0 * kQuarter);
  cairo_close_path(cairo_);
  cairo_fill(cairo_);
}

void Canvas::line(double x0, double y0, double x1, double y1) noexcept {
  cairo_move_to(cairo_, x0, y0);
  cairo_line_to(cairo_, x1, y1);
  cairo_stroke(cairo_);
}

void Canvas::picture(std::span<const std::uint32_t> xrgb, int width_px, int height_px, double x,
                     double y, double box_width, double box_height) {
  cairo_surface_t* image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
  if (cairo_surface_status(image) != CAIRO_STATUS_SUCCESS) {
    cairo_surface_destroy(image);
    throw std::bad_alloc();
  }
  cairo_surface_flush(image);
  unsigned char* rows = cairo_image_surface_get_data(image);
  for (int row = 0; row < height_px; ++row) {
    const auto from = xrgb.subspan(static_cast<std::size_t>(row) * width_px, width_px);
    auto* to = reinterpret_cast<std::uint32_t*>(rows + static_cast<std::ptrdiff_t>(row) *
                                                           cairo_image_surface_get_stride(image));
    std::copy(from.begin(), from.end(), to);
  }
  cairo_surface_mark_dirty(image);
  cairo_save(cairo_);
  cairo_rectangle(cairo_, x, y, box_width, box_height);
  cairo_clip(cairo_);
  cairo_translate(cairo_, x, y);
  cairo_scale(cairo_, box_width / width_px, box_height / height_px);
  cairo_set_source_surface(cairo_, image, 0.0, 0.0);
  cairo_pattern_set_extend(cairo_get_source(cairo_), CAIRO_EXTEND_PAD);
  cairo_pattern_set_filter(cairo_get_source(cairo_), CAIRO_FILTER_BILINEAR);
  cairo_paint(cairo_);
  cairo_restore(cairo_);
  cairo_surface_destroy(image);
}

void Canvas::font(double size_px, bool bold) noexcept {
  cairo_select_font_face(cairo_, kFont, CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_, size_px);
}

double Canvas::text_width(const std::string& text) const noexcept {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_, text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(double x, double y, const std::string& text) noexcept {
  cairo_move_to(cairo_, x, y);
  cairo_show_text(cairo_, text.c_str());
}

std::vector<std::byte> Canvas::png() const {
  std::vector<std::byte> bytes;
  if (cairo_status(cairo_) != CAIRO_STATUS_SUCCESS ||
      cairo_surface_write_to_png_stream(surface_, append, &bytes) != CAIRO_STATUS_SUCCESS) {
    throw std::bad_alloc();
  }
  return bytes;
}

}  // namespace flatpose::tool

#if defined(__SANITIZE_ADDRESS__)
// fontconfig keeps some patterns until the program ends and never frees them.
extern "C" {
const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's names
const char* __lsan_default_options();       // NOLINT
const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
const char* __lsan_default_options() { return "print_suppressions=0"; }
}
#endif
