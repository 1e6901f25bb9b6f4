#include "port/linux/tool/legend.hpp"

#include <cmath>

#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

constexpr Colour kPaper{0.115, 0.125, 0.145};

/// The largest of 1, 2, 5 times a power of ten that is not above `length_mm`.
double round_length_mm(double length_mm) {
  const double power = std::pow(10.0, std::floor(std::log10(length_mm)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= length_mm) return step * power;
  }
  return power;
}

void draw_scale_bar(Canvas& canvas, double px_per_mm, double x, double y) {
  const double length_mm = round_length_mm(150.0 / px_per_mm);
  const double length_px = length_mm * px_per_mm;
  constexpr int kParts = 4;
  for (int i = 0; i < kParts; ++i) {
    canvas.colour(i % 2 == 0 ? kInk : kFaint);
    canvas.box(x + i * length_px / kParts, y, length_px / kParts, 6.0);
  }
  canvas.font(13.0);
  canvas.colour(kInk);
  canvas.text(x, y + 23.0, formatted("%g mm", length_mm));
}

// The tint as z in the frame at the face: in a scan seen along +z it falls toward the top.
double draw_heights(Canvas& canvas, const Relief& relief, int up_sign, double right, double y) {
  constexpr int kWidth = 150;
  for (int i = 0; i < kWidth; ++i) {
    canvas.colour(tint(i / (kWidth - 1.0)));
    canvas.box(right - kWidth + i, y, 1.0, 8.0);
  }
  canvas.font(13.0);
  canvas.colour(kInk);
  const std::string low = formatted("z %.1f", up_sign * relief.low_mm);
  const std::string high = formatted("%.1f mm", up_sign * relief.high_mm);
  canvas.text(right - kWidth, y + 23.0, low);
  canvas.text(right - canvas.text_width(high), y + 23.0, high);
  return right - kWidth;
}

// x, y, z as letters in their colours.
double draw_key(Canvas& canvas, double right, double y) {
  canvas.font(13.0, true);
  double x = right - 62.0;
  for (int i = 0; i < 3; ++i) {
    canvas.colour(kAxes[i]);
    canvas.box(x + i * 22.0, y - 3.5, 8.0, 3.0);
    canvas.text(x + i * 22.0, y + 14.0, std::string(1, "xyz"[i]));
  }
  return x;
}

std::string shortened(const Canvas& canvas, std::string text, double width_px) {
  if (canvas.text_width(text) <= width_px) return text;
  // Whole UTF-8 characters go, from the end.
  while (!text.empty() && canvas.text_width(text + "...") > width_px) {
    do {
      const auto last = static_cast<unsigned char>(text.back());
      text.pop_back();
      if ((last & 0xC0U) != 0x80U) break;
    } while (!text.empty());
  }
  return text + "...";
}

}  // namespace

void draw_legend(Canvas& canvas, double px_per_mm, const Relief& relief, const std::string& title,
                 const LoadedScan& loaded) {
  const double top = canvas.height_px() - kLegend_px;
  canvas.colour(kPaper);
  canvas.box(0.0, top, canvas.width_px(), kLegend_px);
  double left = 16.0;
  double right = canvas.width_px() - 16.0;
  if (!relief.xrgb.empty()) {
    draw_scale_bar(canvas, px_per_mm, left, top + 16.0);
    left += 190.0;
    right = draw_heights(canvas, relief, loaded.up_sign(), right, top + 14.0) - 20.0;
    right = draw_key(canvas, right, top + 23.0) - 16.0;
  }
  canvas.font(15.0, true);
  canvas.colour(kInk);
  canvas.text(left, top + 23.0, shortened(canvas, title, right - left));
  canvas.font(12.0);
  canvas.colour(kFaint);
  const std::string detail =
      formatted("frame %s, seen from above (%s by %s)", loaded.frame_name(),
                port::to_string(loaded.scan.up), loaded.scan.up_reason.c_str());
  canvas.text(left, top + 41.0, shortened(canvas, detail, right - left));
}

}  // namespace flatpose::tool
