#pragma once
// A picture as large as the scan in which somebody painted what the part is: red its edges, blue
// its surface, green its origin (Ingberg 2015 labels its teaching data in this way). A colour
// counts when its channel is above 128 and the two others are below 100, so soft brushes do no
// harm; everything else, transparent pixels too, is no label.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "flatpose/core/image_view.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {

enum Label : std::uint8_t { kLabelNone = 0, kLabelEdge = 1, kLabelSurface = 2, kLabelOrigin = 3 };

/// A place between pixels: 0 is the middle of the first.
struct PixelPosition {
  double column_px = 0.0;
  double row_px = 0.0;
};

struct LabelMask {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> label;  ///< A Label for every pixel, row by row.
  std::int64_t edge_count = 0;
  std::int64_t surface_count = 0;
  std::optional<PixelPosition> origin;  ///< The middle of all green.

  [[nodiscard]] ImageView<const std::uint8_t> view() const noexcept {
    return {label.data(), width_px, height_px, width_px};
  }
};

/// Reads the mask at `path` for a scan of the given size.
/// Fails: InputError when it is no 8-bit colour PNG of that size or has neither red nor blue.
[[nodiscard]] LabelMask read_mask_png(const std::string& path, int scan_width_px,
                                      int scan_height_px, const ReadLimits& limits = {});

}  // namespace flatpose::port
