#include "port/linux/files/mask_png.hpp"

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/png_image.hpp"

namespace flatpose::port {
namespace {

constexpr int kDominantMin = 129;
constexpr int kOtherMax = 99;
constexpr int kOpaqueMin = 128;

Label label_of(const std::uint8_t* rgba) {
  if (rgba[3] < kOpaqueMin) return kLabelNone;
  const auto rules = [&](int channel) {
    return rgba[channel] >= kDominantMin && rgba[(channel + 1) % 3] <= kOtherMax &&
           rgba[(channel + 2) % 3] <= kOtherMax;
  };
  if (rules(0)) return kLabelEdge;
  if (rules(1)) return kLabelOrigin;
  if (rules(2)) return kLabelSurface;
  return kLabelNone;
}

std::string shape(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

}  // namespace

LabelMask read_mask_png(const std::string& path, int scan_width_px, int scan_height_px,
                        const ReadLimits& limits) {
  const std::vector<std::byte> bytes = read_file(path, limits.max_file_bytes);
  if (!is_png(bytes)) throw InputError(path, "it is no PNG", "save the mask as 8-bit colour PNG");
  const PngImage image = read_png(path, bytes, PngKind::kColour8, limits);
  if (image.width_px != scan_width_px || image.height_px != scan_height_px)
    throw InputError(path,
                     "the mask is " + shape(image.width_px, image.height_px) +
                         " pixels and the scan " + shape(scan_width_px, scan_height_px),
                     "paint it on a picture of the scan, pixel for pixel");
  LabelMask mask{image.width_px, image.height_px, {}, 0, 0, {}};
  mask.label.resize(image.rgba.size() / 4);
  std::int64_t origin_count = 0;
  std::int64_t column_sum_px = 0;
  std::int64_t row_sum_px = 0;
  for (std::size_t i = 0; i < mask.label.size(); ++i) {
    const Label label = label_of(&image.rgba[4 * i]);
    mask.label[i] = label;
    mask.edge_count += label == kLabelEdge;
    mask.surface_count += label == kLabelSurface;
    if (label != kLabelOrigin) continue;
    ++origin_count;
    const auto width_px = static_cast<std::size_t>(mask.width_px);
    column_sum_px += static_cast<std::int64_t>(i % width_px);
    row_sum_px += static_cast<std::int64_t>(i / width_px);
  }
  if (mask.edge_count == 0 && mask.surface_count == 0)
    throw InputError(path, "it has neither red nor blue pixels",
                     "paint edges red, the surface blue and the origin green, in pure colours");
  if (origin_count > 0) {
    const auto count = static_cast<double>(origin_count);
    mask.origin = {static_cast<double>(column_sum_px) / count,
                   static_cast<double>(row_sum_px) / count};
  }
  return mask;
}

}  // namespace flatpose::port
