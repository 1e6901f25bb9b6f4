#include "port/linux/files/sick_json.hpp"

#include <limits>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/base64.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/files/json_text.hpp"

namespace flatpose::port {
namespace {

constexpr std::size_t kValueBytes = 2;

struct HeightMap {
  double origin_mm[3];
  double step_mm[3];
  int width_px;
  int height_px;
  bool big_endian;
  bool zero_is_missing;
  std::vector<std::byte> values;
};

JsonPlace first_image(const std::string& path, const nlohmann::json& json) {
  const JsonPlace top(path, json);
  const char* remedy = "give a height map saved by SICK AppSpace";
  if (top.has("fx"))
    top.fail("is the camera of a depth image, not a scan", "give the PNG beside it");
  if (json.is_array() && json.empty()) top.fail("lists no image", remedy);
  const JsonPlace image =
      json.is_array() ? JsonPlace(path, json[0], "image 0") : JsonPlace(path, json, "the file");
  if (!image.has("class") || !image.has("data")) image.fail("is no SICK image", remedy);
  if (image["class"].text() != "Image")
    image["class"].fail("is \"" + printable(image["class"].text(), 40) + "\", not \"Image\"",
                        remedy);
  return image;
}

bool is_big_endian(const JsonPlace& pixels) {
  const JsonPlace endian = pixels["endian"];
  if (endian.text() == "big") return true;
  if (endian.text() != "little")
    endian.fail("\"" + printable(endian.text(), 40) + "\" is neither \"little\" nor \"big\"",
                "save the height map again");
  return false;
}

void check_type(const JsonPlace& data, const JsonPlace& pixels) {
  const JsonPlace type = data["ImageType"];
  const std::string& name = type.text();
  if (name != "uint16" && name != "UINT16")
    type.fail("is \"" + printable(name, 40) + "\", not \"uint16\"",
              "save the height map with 16-bit values");
  if (pixels.has("elemSz") && pixels["elemSz"].whole_number() != kValueBytes)
    pixels["elemSz"].fail("is not 2", "save the height map with 16-bit values");
  if (pixels.has("elemTypes") && pixels["elemTypes"].element(0, 1).text() != "uint16")
    pixels["elemTypes"].fail("is not [\"uint16\"]", "save the height map with 16-bit values");
}

std::vector<std::byte> decode_values(const JsonPlace& pixels, std::size_t count) {
  const JsonPlace data = pixels["data"];
  const std::size_t size_bytes = count * kValueBytes;
  if (pixels.has("numOfElems") && pixels["numOfElems"].whole_number() != count)
    pixels["numOfElems"].fail("is not Width x Height = " + std::to_string(count));
  const std::size_t length = (size_bytes + 2) / 3 * 4;
  if (data.text().size() != length)
    data.fail("has " + std::to_string(data.text().size()) + " characters where " +
                  std::to_string(count) + " pixels take " + std::to_string(length),
              "copy the file again or correct Width and Height");
  Base64Result decoded = decode_base64(data.text());
  if (decoded.wrong_character)
    data.fail("is not base64 at its character " + std::to_string(*decoded.wrong_character),
              "copy the file again: it is damaged");
  if (decoded.bytes.size() != size_bytes)
    data.fail("holds " + std::to_string(decoded.bytes.size()) + " bytes instead of " +
                  std::to_string(size_bytes),
              "copy the file again: it is damaged");
  return std::move(decoded.bytes);
}

HeightMap read_height_map(const std::string& path, const JsonPlace& image,
                          const ReadLimits& limits) {
  const JsonPlace data = image["data"];
  const JsonPlace grid = data["Data"];
  const JsonPlace pixels = grid["Pixels"];
  HeightMap map{};
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    map.origin_mm[axis] = data["Origin"][kAxes[axis]].number();
    map.step_mm[axis] = data["PixelSize"][kAxes[axis]].positive_number();
  }
  check_type(grid, pixels);
  const std::uint64_t width_px = grid["Width"].whole_number();
  const std::uint64_t height_px = grid["Height"].whole_number();
  check_shape(path, width_px, height_px, limits, "save a height map of rows and columns");
  map.width_px = static_cast<int>(width_px);
  map.height_px = static_cast<int>(height_px);
  map.big_endian = is_big_endian(pixels);
  // Saying nothing, a pixel without height is rather missing than at the very bottom.
  map.zero_is_missing =
      !data.has("HandleZeroPixels") || data["HandleZeroPixels"].text() == "MissingData";
  map.values = decode_values(pixels, width_px * height_px);
  return map;
}

}  // namespace

bool is_json(std::span<const std::byte> bytes) noexcept {
  const std::string_view text = as_text(bytes).substr(0, 4096);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && (text[first] == '[' || text[first] == '{');
}

Scan read_sick_json(const std::string& path, std::span<const std::byte> bytes,
                    const ReadLimits& limits) {
  const nlohmann::json json = parse_json(path, bytes);
  const HeightMap map = read_height_map(path, first_image(path, json), limits);
  Scan scan;
  scan.width_px = map.width_px;
  scan.height_px = map.height_px;
  scan.up = Up::kPlusZ;
  scan.up_reason = "height map";
  scan.xyz_mm.resize(map.values.size() / kValueBytes * 3);
  const std::byte* value = map.values.data();
  float* p = scan.xyz_mm.data();
  for (int row = 0; row < map.height_px; ++row) {
    for (int column = 0; column < map.width_px; ++column, value += kValueBytes, p += 3) {
      const auto low = std::to_integer<int>(value[map.big_endian ? 1 : 0]);
      const auto high = std::to_integer<int>(value[map.big_endian ? 0 : 1]);
      const int height = high << 8 | low;
      p[0] = to_coordinate(map.origin_mm[0] + column * map.step_mm[0]);
      p[1] = to_coordinate(map.origin_mm[1] + row * map.step_mm[1]);
      p[2] = height == 0 && map.zero_is_missing
                 ? std::numeric_limits<float>::quiet_NaN()
                 : to_coordinate(map.origin_mm[2] + height * map.step_mm[2]);
    }
  }
  check_coordinates(path, scan);
  return scan;
}

}  // namespace flatpose::port
