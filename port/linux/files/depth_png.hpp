#pragma once
// Depth images of a pinhole camera, as the BOP benchmark stores them: NAME.png holds 16-bit grey
// values, NAME.json beside it {"fx", "fy", "cx", "cy", "depth_scale"}. With v the row and u the
// column of a pixel, z = value * depth_scale in mm, x = (u - cx) z / fx, y = (v - cy) z / fy, and a
// value of 0 is missing. The camera looks along +z, so up is -z.

#include <cstddef>
#include <span>
#include <string>

#include "port/linux/files/png_image.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {

/// The scan in the bytes of a depth PNG; its camera is read from the file beside `path`.
/// Fails: InputError.
[[nodiscard]] Scan read_depth_png(const std::string& path, std::span<const std::byte> bytes,
                                  const ReadLimits& limits = {});

/// Whether the file is the camera of a depth image. Never throws.
[[nodiscard]] bool is_depth_camera(const std::string& path) noexcept;

}  // namespace flatpose::port
