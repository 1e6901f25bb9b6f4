#include "port/linux/files/depth_png.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

const std::vector<std::uint16_t> kValues{1000, 0, 65535, 1, 2000, 3000};

struct DepthFiles {
  explicit DepthFiles(std::string_view camera = kCameraJson) {
    folder.write("d.json", camera);
    path = folder.write("d.png", depth_png_of(3, 2, kValues));
  }
  TemporaryFolder folder;
  std::string path;
};

TEST(DepthPng, BecomesPointsByThePinholeOfItsCamera) {
  const DepthFiles files;
  const Scan scan = read_scan(files.path);
  ASSERT_EQ(scan.width_px, 3);
  ASSERT_EQ(scan.height_px, 2);
  EXPECT_EQ(scan.up, Up::kMinusZ);
  EXPECT_EQ(scan.up_reason, "depth image");
  EXPECT_FALSE(scan.viewpoint_mm);
  const RangeImageView view = scan.view();
  for (int v = 0; v < 2; ++v) {
    for (int u = 0; u < 3; ++u) {
      const Vec3 p = view(u, v);
      const double z = 0.1 * kValues[static_cast<std::size_t>(v * 3 + u)];
      if (z == 0.0) {
        EXPECT_TRUE(std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z));
        continue;
      }
      EXPECT_NEAR(p.z, z, 1e-3);
      EXPECT_NEAR(p.x, (u - 1.0) * z / 100.0, 1e-4);
      EXPECT_NEAR(p.y, (v - 0.5) * z / 50.0, 1e-4);
    }
  }
}

TEST(DepthPng, FindsItsCameraBesideIt) {
  const TemporaryFolder folder;
  const std::string png = depth_png_of(3, 2, kValues);
  std::filesystem::create_directory(folder.path("a.b"));
  folder.write("a.b/no_extension.json", kCameraJson);
  EXPECT_EQ(read_scan(folder.write("a.b/no_extension", png)).width_px, 3);
  expect_input_error([&] { (void)read_scan(folder.write("lone.png", png)); },
                     {"lone.png: its camera ", "lone.json is missing", "depth_scale"});
}

TEST(DepthPng, AllMissingIsASoundScan) {
  const TemporaryFolder folder;
  folder.write("d.json", kCameraJson);
  const Scan scan = read_scan(
      folder.write("d.png", depth_png_of(300, 200, std::vector<std::uint16_t>(60'000, 0))));
  EXPECT_EQ(scan.view().size(), 60'000u);
  EXPECT_TRUE(std::isnan(scan.xyz_mm[0]));
}

TEST(DepthPng, NamesWhatIsWrongWithTheCamera) {
  const auto refused = [](std::string_view from, std::string_view to,
                          std::initializer_list<std::string_view> parts) {
    const DepthFiles files(replaced(std::string(kCameraJson), from, to));
    expect_input_error([&] { (void)read_scan(files.path); }, parts);
  };
  refused("\"fx\"", "\"f\"", {"d.json", "has no \"fx\""});
  refused("100.0", "0", {"fx is not above 0"});
  refused("100.0", "-1", {"fx is not above 0"});
  refused("100.0", "\"1\"", {"fx is not a number"});
  refused("100.0", "1e999", {"d.json", "correct the file"});
  refused("100.0", "1e-300", {"pixel (row 0, column 0): x"});
  refused("0.1", "1000", {"row 0, column 2", "1e6 mm"});
  refused("0.1", "null", {"depth_scale is not a number"});
  refused("}", "", {"d.json", "cut off at byte"});
  refused(", \"cx\"", " \"cx\"", {"line 1, column", "not JSON"});
  refused("{", "{\"width\": 4, ", {"width is not the image's 3"});
  refused("{", "[{", {"d.json"});
  const DepthFiles list("[1]");
  expect_input_error([&] { (void)read_scan(list.path); }, {"d.json", "is not an object"});
  const DepthFiles empty("");
  expect_input_error([&] { (void)read_scan(empty.path); }, {"d.json", "cut off"});
}

TEST(DepthPng, IsRefusedInOtherPixels) {
  const DepthFiles files;
  const auto refused = [&](int colour, int depth, std::size_t bytes, std::string_view what) {
    const std::string path =
        files.folder.write("d.png", png_of(3, 2, colour, depth, std::string(bytes, '\x7f')));
    expect_input_error([&] { (void)read_scan(path); }, {what, "save the depth as 16-bit grey"});
  };
  refused(SPNG_COLOR_TYPE_GRAYSCALE, 8, 6, "it is 8-bit grey,");
  refused(SPNG_COLOR_TYPE_TRUECOLOR, 8, 18, "it is 8-bit RGB,");
  refused(SPNG_COLOR_TYPE_TRUECOLOR, 16, 36, "it is 16-bit RGB,");
  refused(SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, 16, 24, "it is 16-bit grey with alpha");
}

TEST(DepthPng, IsRefusedWhereverItIsCutOff) {
  const DepthFiles files;
  const std::string png = depth_png_of(3, 2, kValues);
  for (std::size_t size = 0; size < png.size(); ++size)
    expect_input_error([&] { (void)read_scan(files.folder.write("d.png", png.substr(0, size))); },
                       {"d.png"});
}

TEST(DepthPng, IsRefusedOverTheLimitBeforeItIsUnpacked) {
  const DepthFiles files;
  expect_input_error([&] { (void)read_scan(files.path, {5}); },
                     {"3 x 2", "limit of 5", "--max-points to 6"});
  const auto header_says = [](std::uint32_t width_px, std::uint32_t height_px) {
    // The checksum of a PNG's header is 32 bits over its chunk; computed here bit by bit.
    std::string png = depth_png_of(3, 2, kValues);
    const auto put = [&](std::size_t at, std::uint32_t value) {
      for (std::size_t i = 0; i < 4; ++i) png[at + i] = static_cast<char>(value >> (24 - 8 * i));
    };
    put(16, width_px);
    put(20, height_px);
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = 12; i < 29; ++i) {
      crc ^= static_cast<unsigned char>(png[i]);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
    put(29, ~crc);
    return png;
  };
  const auto refused = [&](std::uint32_t width_px, std::uint32_t height_px,
                           std::initializer_list<std::string_view> parts) {
    const std::string path = files.folder.write("d.png", header_says(width_px, height_px));
    expect_input_error([&] { (void)read_scan(path); }, parts);
  };
  refused(2000, 2000, {"cannot hold 2000 x 2000", "damaged"});
  refused(4000, 2000, {"4000 x 2000", "--max-points to 8000000"});
  refused(0x7FFFFFFF, 0x7FFFFFFF, {"1000000 pixels"});
  refused(3, 1, {"3 x 1", "not organized"});
  refused(3, 0, {"damaged PNG"});
  refused(3, 3, {"damaged PNG"});
}

}  // namespace
}  // namespace flatpose::port
