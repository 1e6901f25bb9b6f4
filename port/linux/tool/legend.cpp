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

double draw_heights(Canvas& canvas, const Relief& relief, const Frames& frames, double right,
                    double y) {
  constexpr int kWidth = 150;
  for (int i = 0; i < kWidth; ++i) {
    canvas.colour(tint(i / (kWidth - 1.0)));
    canvas.box(right - kWidth + i, y, 1.0, 8.0);
  }
  canvas.font(13.0);
  canvas.colour(kInk);
  const HeightText text = height_text(relief, frames);
  canvas.text(right - kWidth, y + 23.0, text.low);
  canvas.text(right - canvas.text_width(text.high), y + 23.0, text.high);
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

HeightText height_text(const Relief& relief, const Frames& frames) {
  constexpr double kShown_mm = 0.1;
  const auto& to_z = frames.face_T_work.rotation.m;
  const rectify::Grid& grid = relief.grid;
  const double across_mm =
      grid.cell_mm * (std::fabs(to_z[6]) * grid.width_px + std::fabs(to_z[7]) * grid.height_px);
  const bool is_above_plane = across_mm > 0.5 * kShown_mm;
  const auto shown = [&](double height_mm) {
    const Vec3 middle{grid.x_of(0.5 * grid.width_px), grid.y_of(0.5 * grid.height_px), height_mm};
    return is_above_plane ? height_mm : (frames.face_T_work * middle).z;
  };
  return {formatted(is_above_plane ? "height %.1f" : "z %.1f", shown(relief.low_mm)),
          formatted("%.1f mm", shown(relief.high_mm))};
}

std::string frame_text(const LoadedScan& loaded) {
  return formatted("frame %s, seen from above (%s by %s)", loaded.frame_name(),
                   port::to_string(loaded.scan.up), loaded.scan.up_reason.c_str());
}

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
    right = draw_heights(canvas, relief, loaded.frames, right, top + 14.0) - 20.0;
    right = draw_key(canvas, right, top + 23.0) - 16.0;
  }
  canvas.font(15.0, true);
  canvas.colour(kInk);
  canvas.text(left, top + 23.0, shortened(canvas, title, right - left));
  canvas.font(12.0);
  canvas.colour(kFaint);
  canvas.text(left, top + 41.0, shortened(canvas, frame_text(loaded), right - left));
}

}  // namespace flatpose::tool
