#pragma once
// The strip under a picture: scale bar, title, frame, the axes' colours and the heights' tint.

#include <string>

#include "port/linux/tool/canvas.hpp"
#include "port/linux/tool/loaded_scan.hpp"
#include "port/linux/tool/relief.hpp"

namespace flatpose::tool {

inline constexpr double kLegend_px = 54.0;

inline constexpr Colour kInk{0.93, 0.94, 0.95};
inline constexpr Colour kFaint{0.62, 0.66, 0.70};
/// x, y, z.
inline constexpr Colour kAxes[] = {{0.98, 0.27, 0.25}, {0.25, 0.86, 0.35}, {0.30, 0.55, 1.0}};

/// The heights that the tint spans, as text.
struct HeightText {
  std::string low;
  std::string high;
};
/// As z of the frame at the face, where that is one number all over the map to the digit shown;
/// else as heights above the work plane.
[[nodiscard]] HeightText height_text(const Relief& relief, const Frames& frames);

/// Which frame the numbers are in, and which side is up.
[[nodiscard]] std::string frame_text(const LoadedScan& loaded);

/// Draws it over the canvas's lowest kLegend_px. `title` must be UTF-8.
void draw_legend(Canvas& canvas, double px_per_mm, const Relief& relief, const std::string& title,
                 const LoadedScan& loaded);

}  // namespace flatpose::tool
