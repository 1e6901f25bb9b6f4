#pragma once
// Height maps of SICK AppSpace in JSON: a list of images, or one, of which the first is the height
// map (others, reflectance for one, are not looked at). x = Origin.x + column * PixelSize.x,
// y = Origin.y + row * PixelSize.y, z = Origin.z + value * PixelSize.z in mm; the values are
// base64 of uint16, little or big endian, row by row. z is height, so up is +z. A 0 is missing, if
// HandleZeroPixels says MissingData or says nothing.

#include <cstddef>
#include <span>
#include <string>

#include "port/linux/files/scan.hpp"

namespace flatpose::port {

/// Whether the file starts like JSON.
[[nodiscard]] bool is_json(std::span<const std::byte> bytes) noexcept;

/// The scan in the bytes of a height map; `path` is for messages.  Fails: InputError.
[[nodiscard]] Scan read_sick_json(const std::string& path, std::span<const std::byte> bytes,
                                  const ReadLimits& limits = {});

}  // namespace flatpose::port
