#include "port/linux/files/scan.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/depth_png.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/pcd.hpp"
#include "port/linux/files/sick_json.hpp"

namespace flatpose::port {
namespace {

constexpr const char* kKnownFormats =
    "give an organized PCD 0.7, a 16-bit depth PNG with its JSON, or a SICK height map in JSON";

Scan read_known(const std::string& path, const ReadLimits& limits) {
  const std::vector<std::byte> bytes = read_file(path, limits.max_file_bytes);
  if (bytes.empty()) throw InputError(path, "it is empty", "copy the file again");
  if (is_pcd(bytes)) return read_pcd(path, bytes, limits);
  if (is_png(bytes)) return read_depth_png(path, bytes, limits);
  if (is_json(bytes)) return read_sick_json(path, bytes, limits);
  const std::string start(as_text(bytes).substr(0, 8));
  throw InputError(path, "no known kind of scan: it starts with \"" + printable(start, 40) + "\"",
                   kKnownFormats);
}

}  // namespace

const char* to_string(Up up) noexcept { return up == Up::kPlusZ ? "+z" : "-z"; }

std::optional<Up> parse_up(std::string_view text) noexcept {
  if (text == "+z") return Up::kPlusZ;
  if (text == "-z") return Up::kMinusZ;
  return {};
}

RangeImageView Scan::view() const noexcept {
  constexpr std::ptrdiff_t kPixelBytes = 3 * sizeof(float);
  const float* first = xyz_mm.data();
  return {first, first + 1, first + 2, width_px, height_px, kPixelBytes, kPixelBytes * width_px};
}

void override_up(Scan& scan, Up up) {
  scan.up = up;
  scan.up_reason = "option";
}

float to_coordinate(double value_mm) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (value_mm > kLargest) return std::numeric_limits<float>::infinity();
  if (value_mm < -kLargest) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(value_mm);
}

void check_shape(const std::string& path, std::uint64_t width_px, std::uint64_t height_px,
                 const ReadLimits& limits, std::string_view how_to_organize) {
  const std::string shape = std::to_string(width_px) + " x " + std::to_string(height_px);
  if (width_px == 0 || height_px == 0)
    throw InputError(path, shape + " pixels hold nothing", "save a scan that has points");
  if (width_px == 1 || height_px == 1)
    throw InputError(path, shape + " pixels are not organized as an image", how_to_organize);
  if (width_px > kDimensionMax_px || height_px > kDimensionMax_px)
    throw InputError(
        path,
        shape + " pixels are more than " + std::to_string(kDimensionMax_px) + " in a row or column",
        "check the file or crop the scan");
  const std::uint64_t count = width_px * height_px;  // both below 2^20
  if (std::cmp_greater(count, limits.max_points))
    throw InputError(path,
                     shape + " pixels are more than the limit of " +
                         std::to_string(limits.max_points) + " points",
                     "raise --max-points to " + std::to_string(count) + " or crop the scan");
}

void check_coordinates(const std::string& path, const Scan& scan) {
  for (std::size_t i = 0; i < scan.xyz_mm.size(); ++i) {
    const double value_mm = static_cast<double>(scan.xyz_mm[i]);
    if (!(std::fabs(value_mm) > kCoordinateMax_mm)) continue;  // NaN is missing, and legal
    const std::size_t pixel = i / 3;
    const auto width_px = static_cast<std::size_t>(scan.width_px);
    const std::string where = "pixel (row " + std::to_string(pixel / width_px) + ", column " +
                              std::to_string(pixel % width_px) + "): " + "xyz"[i % 3];
    if (std::isinf(value_mm))
      throw InputError(path, where + " is infinite", "write NaN where a point is missing");
    throw InputError(path, where + " lies beyond +-1e6 mm",
                     "check that the file holds mm and is not damaged");
  }
}

Scan read_scan(const std::string& path, const ReadLimits& limits, std::optional<Up> up_option) {
  Scan scan = read_known(path, limits);
  if (up_option) override_up(scan, *up_option);
  return scan;
}

}  // namespace flatpose::port
