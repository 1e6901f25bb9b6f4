#include "port/linux/files/mask_png.hpp"

#include <gtest/gtest.h>

#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

using Bytes = std::initializer_list<int>;

std::string bytes_of(Bytes values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

LabelMask mask_of(const std::string& png, int width_px = 3, int height_px = 2) {
  const TemporaryFolder folder;
  return read_mask_png(folder.write("m.png", png), width_px, height_px);
}

const std::vector<std::uint8_t> kExpected{kLabelEdge, kLabelSurface, kLabelOrigin,
                                          kLabelNone, kLabelSurface, kLabelOrigin};

TEST(MaskPng, ReadsRgb) {
  const LabelMask mask = mask_of(png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 8,
                                        bytes_of({255, 0, 0, 0, 0, 255, 0, 255, 0,  //
                                                  200, 99, 150, 9, 9, 129, 99, 129, 99})));
  EXPECT_EQ(mask.label, kExpected);
  EXPECT_EQ(mask.edge_count, 1);
  EXPECT_EQ(mask.surface_count, 2);
  ASSERT_TRUE(mask.origin);
  EXPECT_EQ(mask.origin->column_px, 2.0);
  EXPECT_EQ(mask.origin->row_px, 0.5);
  EXPECT_EQ(mask.view()(1, 1), kLabelSurface);
}

TEST(MaskPng, ReadsRgbaAndTakesTransparentAsNothing) {
  const LabelMask mask =
      mask_of(png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 8,
                     bytes_of({255, 0, 0, 255, 0, 0, 255, 128, 0, 255, 0, 255,  //
                               255, 0, 0, 127, 0, 0, 255, 255, 0, 255, 0, 255})));
  EXPECT_EQ(mask.label, kExpected);
}

TEST(MaskPng, ReadsPalettes) {
  const LabelMask eight =
      mask_of(png_of(3, 2, SPNG_COLOR_TYPE_INDEXED, 8, bytes_of({1, 2, 3, 0, 2, 3}), true));
  EXPECT_EQ(eight.label, kExpected);
  const LabelMask two =
      mask_of(png_of(3, 2, SPNG_COLOR_TYPE_INDEXED, 2, bytes_of({0b01101100, 0b00101100}), true));
  EXPECT_EQ(two.label, kExpected);
}

TEST(MaskPng, HasNoOriginWithoutGreen) {
  std::string pixels;
  for (int i = 0; i < 6; ++i) pixels += bytes_of({10, 10, 240});
  const LabelMask mask = mask_of(png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 8, pixels));
  EXPECT_FALSE(mask.origin);
  EXPECT_EQ(mask.surface_count, 6);
}

TEST(MaskPng, ToleranceEndsAtItsBounds) {
  const auto label = [](Bytes rgb) {
    std::string pixels = bytes_of(rgb);
    for (int i = 0; i < 5; ++i) pixels += bytes_of({255, 0, 0});
    return mask_of(png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 8, pixels)).label[0];
  };
  EXPECT_EQ(label({129, 99, 99}), kLabelEdge);
  EXPECT_EQ(label({128, 0, 0}), kLabelNone);
  EXPECT_EQ(label({255, 100, 0}), kLabelNone);
  EXPECT_EQ(label({255, 0, 100}), kLabelNone);
  EXPECT_EQ(label({255, 255, 255}), kLabelNone);
}

TEST(MaskPng, NamesWhatIsWrong) {
  const std::string rgb =
      png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 8, bytes_of({255, 0, 0}) + std::string(15, '\0'));
  expect_input_error([&] { (void)mask_of(rgb, 2, 3); },
                     {"mask is 3 x 2 pixels and the scan 2 x 3", "pixel for pixel"});
  expect_input_error(
      [&] { (void)mask_of(png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 8, std::string(18, '\0'))); },
      {"neither red nor blue", "paint edges red"});
  expect_input_error(
      [&] { (void)mask_of(png_of(3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 8, std::string(6, '\0'))); },
      {"8-bit grey, not 8-bit colour"});
  expect_input_error(
      [&] { (void)mask_of(png_of(3, 2, SPNG_COLOR_TYPE_TRUECOLOR, 16, std::string(36, '\0'))); },
      {"16-bit RGB, not 8-bit colour"});
  expect_input_error([&] { (void)mask_of("GIF89a"); }, {"it is no PNG"});
  expect_input_error([&] { (void)read_mask_png("/nowhere/m.png", 3, 2); }, {"No such file"});
  for (std::size_t size = 0; size < rgb.size(); ++size)
    expect_input_error([&] { (void)mask_of(rgb.substr(0, size)); }, {"m.png"});
}

}  // namespace
}  // namespace flatpose::port
