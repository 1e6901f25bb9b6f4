#pragma once
// Small files of every kind, made byte by byte for the tests.

#include <lzf.h>
#include <spng.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace flatpose::port {

inline constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

template <class T>
void append_raw(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

// A 3 x 2 scan: z = 100 + index, one point missing.
inline std::vector<float> small_xyz() {
  std::vector<float> xyz;
  for (int i = 0; i < 6; ++i) {
    const bool missing = i == 4;
    xyz.push_back(missing ? kMissing : 0.5f * static_cast<float>(i % 3) - 1.0f);
    xyz.push_back(missing ? kMissing : 0.25f * static_cast<float>(i / 3));
    xyz.push_back(missing ? kMissing : 100.0f + static_cast<float>(i));
  }
  return xyz;
}

struct PcdLines {
  std::string fields = "x y z";
  std::string size = "4 4 4";
  std::string type = "F F F";
  std::string count = "1 1 1";
  std::string width = "3";
  std::string height = "2";
  std::string viewpoint = "0 0 0 1 0 0 0";
  std::string points = "6";
  std::string data = "binary";

  [[nodiscard]] std::string text() const {
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " +
           size + "\nTYPE " + type + "\nCOUNT " + count + "\nWIDTH " + width + "\nHEIGHT " +
           height + "\nVIEWPOINT " + viewpoint + "\nPOINTS " + points + "\nDATA " + data + "\n";
  }
};

// Fields around and between the coordinates, of every size.
inline PcdLines mixed_lines() {
  PcdLines lines;
  lines.fields = "rgb y pad x normal z time";
  lines.size = "4 4 1 4 4 4 8";
  lines.type = "U F U F F F F";
  lines.count = "1 1 5 1 3 1 1";
  return lines;
}

inline std::string raw_points(const std::vector<float>& xyz) {
  return {reinterpret_cast<const char*>(xyz.data()), xyz.size() * sizeof(float)};
}

inline std::string mixed_points(const std::vector<float>& xyz) {
  std::string bytes;
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    append_raw(bytes, std::uint32_t{0xFFFFFFFF});
    append_raw(bytes, xyz[i + 1]);
    bytes += "ABCDE";
    append_raw(bytes, xyz[i]);
    for (int k = 0; k < 3; ++k) append_raw(bytes, std::numeric_limits<float>::infinity());
    append_raw(bytes, xyz[i + 2]);
    append_raw(bytes, 1e300);
  }
  return bytes;
}

inline std::string packed_by_lzf(const std::string& plain) {
  std::vector<char> packed(plain.size() * 2 + 64);
  const unsigned size = lzf_compress(plain.data(), static_cast<unsigned>(plain.size()),
                                     packed.data(), static_cast<unsigned>(packed.size()));
  if (size == 0) throw std::runtime_error("lzf_compress");
  std::string bytes;
  append_raw(bytes, static_cast<std::uint32_t>(size));
  append_raw(bytes, static_cast<std::uint32_t>(plain.size()));
  return bytes.append(packed.data(), size);
}

// All x, then all y, then all z, as PCL packs them.
inline std::string packed_points(const std::vector<float>& xyz) {
  std::string plain;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = axis; i < xyz.size(); i += 3) append_raw(plain, xyz[i]);
  return packed_by_lzf(plain);
}

inline std::string small_ascii() {
  return "-1 0 100\n-0.5 0 1.01e2\n0 0 102\n-1 0.25 103\nnan nan nan\n0 0.25 105\n";
}

// A PNG of pixels as libspng takes them: 16-bit grey in host order, else bytes by channel.
inline std::string png_of(std::uint32_t width_px, std::uint32_t height_px, int colour_type,
                          int bit_depth, const std::string& pixels, bool with_palette = false) {
  spng_ctx* context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_option(context, SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header{};
  header.width = width_px;
  header.height = height_px;
  header.color_type = static_cast<std::uint8_t>(colour_type);
  header.bit_depth = static_cast<std::uint8_t>(bit_depth);
  spng_set_ihdr(context, &header);
  if (with_palette) {
    spng_plte palette{};
    palette.n_entries = 4;
    palette.entries[1] = {255, 0, 0, 0};
    palette.entries[2] = {0, 0, 255, 0};
    palette.entries[3] = {0, 255, 0, 0};
    spng_set_plte(context, &palette);
  }
  const int failed =
      spng_encode_image(context, pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  std::size_t size_bytes = 0;
  int error = 0;
  void* buffer = spng_get_png_buffer(context, &size_bytes, &error);
  spng_ctx_free(context);
  if (failed != 0 || buffer == nullptr) throw std::runtime_error("cannot make the PNG");
  std::string bytes(static_cast<const char*>(buffer), size_bytes);
  std::free(buffer);
  return bytes;
}

inline std::string depth_png_of(std::uint32_t width_px, std::uint32_t height_px,
                                const std::vector<std::uint16_t>& values) {
  return png_of(width_px, height_px, SPNG_COLOR_TYPE_GRAYSCALE, 16,
                {reinterpret_cast<const char*>(values.data()), values.size() * 2});
}

inline constexpr std::string_view kCameraJson =
    R"({"fx": 100.0, "fy": 50, "cx": 1, "cy": 0.5, "depth_scale": 0.1})";

// 2 x 2 values 1, 2, 0, 258 in little endian.
inline constexpr std::string_view kSickJson = R"([
 {"class": "Image", "data": {
   "PixelSize": {"x": 0.5, "y": 0.25, "z": 0.1}, "Origin": {"x": -10.0, "y": 20, "z": 5.0},
   "HandleZeroPixels": "MissingData",
   "Data": {"ImageType": "uint16", "Width": 2, "Height": 2,
            "Pixels": {"numOfElems": 4, "elemSz": 2, "endian": "little", "elemTypes": ["uint16"],
                       "data": "AQACAAAAAgE="}}}},
 {"class": "Image", "data": "reflectance, not looked at"}])";

// `text` with the first `from` replaced.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("nothing to replace");
  return text.replace(at, from.size(), to);
}

}  // namespace flatpose::port
