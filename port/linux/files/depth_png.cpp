#include "port/linux/files/depth_png.hpp"

#include <sys/stat.h>

#include <limits>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/json_text.hpp"

namespace flatpose::port {
namespace {

constexpr std::int64_t kCameraBytesMax = 1024 * 1024;

struct Camera {
  double fx_px;
  double fy_px;
  double cx_px;
  double cy_px;
  double mm_per_value;
};

std::string camera_path(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t dot = path.rfind('.');
  const bool has_extension = dot != std::string::npos && dot > name;
  return (has_extension ? path.substr(0, dot) : path) + ".json";
}

Camera read_camera(const std::string& path, const PngImage& image) {
  const std::string json_path = camera_path(path);
  struct stat info {};
  if (::stat(json_path.c_str(), &info) != 0)
    throw InputError(path, "its camera " + json_path + " is missing",
                     "write {\"fx\", \"fy\", \"cx\", \"cy\", \"depth_scale\"} there");
  const nlohmann::json json = parse_json(json_path, read_file(json_path, kCameraBytesMax));
  const JsonPlace camera(json_path, json);
  for (const auto& [key, size_px] :
       {std::pair{"width", image.width_px}, std::pair{"height", image.height_px}})
    if (camera.has(key) && std::cmp_not_equal(camera[key].whole_number(), size_px))
      camera[key].fail("is not the image's " + std::to_string(size_px),
                       "put the camera of this image beside it");
  return {camera["fx"].positive_number(), camera["fy"].positive_number(), camera["cx"].number(),
          camera["cy"].number(), camera["depth_scale"].positive_number()};
}

}  // namespace

Scan read_depth_png(const std::string& path, std::span<const std::byte> bytes,
                    const ReadLimits& limits) {
  const PngImage image = read_png(path, bytes, PngKind::kGrey16, limits);
  const Camera camera = read_camera(path, image);
  Scan scan;
  scan.width_px = image.width_px;
  scan.height_px = image.height_px;
  scan.up = Up::kMinusZ;
  scan.up_reason = "depth image";
  scan.xyz_mm.assign(3 * image.grey.size(), std::numeric_limits<float>::quiet_NaN());
  std::size_t i = 0;
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u, ++i) {
      if (image.grey[i] == 0) continue;
      const double z_mm = image.grey[i] * camera.mm_per_value;
      scan.xyz_mm[3 * i] = to_coordinate((u - camera.cx_px) * z_mm / camera.fx_px);
      scan.xyz_mm[3 * i + 1] = to_coordinate((v - camera.cy_px) * z_mm / camera.fy_px);
      scan.xyz_mm[3 * i + 2] = to_coordinate(z_mm);
    }
  }
  check_coordinates(path, scan);
  return scan;
}

bool is_depth_camera(const std::string& path) noexcept {
  try {
    const nlohmann::json json = parse_json(path, read_file(path, kCameraBytesMax));
    return json.is_object() && json.contains("fx") && json.contains("depth_scale");
  } catch (...) {
    return false;
  }
}

}  // namespace flatpose::port
