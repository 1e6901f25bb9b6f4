#include "port/linux/files/sick_json.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

Scan scan_of(const std::string& text) { return read_sick_json("t.json", as_bytes(text)); }
std::string with(std::string_view from, std::string_view to) {
  return replaced(std::string(kSickJson), from, to);
}

TEST(SickJson, IsOriginPlusIndexTimesPixelSize) {
  const Scan scan = scan_of(std::string(kSickJson));
  ASSERT_EQ(scan.width_px, 2);
  ASSERT_EQ(scan.height_px, 2);
  EXPECT_EQ(scan.up, Up::kPlusZ);
  EXPECT_EQ(scan.up_reason, "height map");
  const float expected[] = {-10.0f, 20.0f,  5.1f,     -9.5f, 20.0f,  5.2f,
                            -10.0f, 20.25f, kMissing, -9.5f, 20.25f, 30.8f};
  for (std::size_t i = 0; i < 12; ++i) {
    if (std::isnan(expected[i])) {
      EXPECT_TRUE(std::isnan(scan.xyz_mm[i])) << i;
    } else {
      EXPECT_NEAR(scan.xyz_mm[i], expected[i], 1e-5) << i;
    }
  }
}

TEST(SickJson, TurnsBigEndianRound) {
  const Scan scan = scan_of(replaced(with("little", "big"), "AQACAAAAAgE=", "AAEAAgAAAQI="));
  EXPECT_NEAR(scan.xyz_mm[2], 5.1, 1e-5);
  EXPECT_NEAR(scan.xyz_mm[11], 30.8, 1e-5);
}

TEST(SickJson, ZeroIsMissingUnlessTheFileSaysOtherwise) {
  EXPECT_NEAR(scan_of(with("MissingData", "ValidData")).xyz_mm[8], 5.0, 1e-6);
  EXPECT_TRUE(std::isnan(scan_of(with("\"HandleZeroPixels\": \"MissingData\",", "")).xyz_mm[8]));
}

TEST(SickJson, TakesOneImageWithoutAList) {
  const std::string list(kSickJson);
  const std::size_t end = list.find(",\n {\"class\"");
  EXPECT_EQ(scan_of(list.substr(1, end - 1)).width_px, 2);
}

TEST(SickJson, NamesWhatIsWrong) {
  const auto refused = [](std::string_view from, std::string_view to,
                          std::initializer_list<std::string_view> parts) {
    expect_input_error([&] { (void)scan_of(with(from, to)); }, parts);
  };
  refused("little", "middle", {"endian \"middle\"", "neither"});
  refused("little", "lit\\u001b[2Jtle", {"lit\\x1b[2Jtle"});
  refused("\"endian\": \"little\",", "", {"Pixels has no \"endian\""});
  refused("AQACAAAAAgE=", "AQACAAAAAgE", {"11 characters", "4 pixels take 12"});
  refused("AQACAAAAAgE=", "AQACAAAAAgEA", {"9 bytes instead of 8"});
  refused("AQACAAAAAgE=", "AQACAAA*AgE=", {"not base64 at its character 7"});
  refused("AQACAAAAAgE=", "", {"0 characters"});
  refused("\"AQACAAAAAgE=\"", "[1, 2, 0, 258]", {"data is not a text"});
  refused("\"Width\": 2", "\"Width\": 3", {"numOfElems is not Width x Height = 6"});
  refused("\"Width\": 2", "\"Width\": -2", {"Width is not a whole number"});
  refused("\"Width\": 2", "\"Width\": 2.5", {"Width is not a whole number"});
  refused("\"Width\": 2", "\"Width\": 1e30", {"Width is not a whole number"});
  refused("\"Width\": 2", "\"Width\": 18446744073709551615", {"1000000 in a row"});
  refused("\"Width\": 2", "\"Width\": 0", {"hold nothing"});
  refused("\"Width\": 2", "\"Width\": 1", {"not organized"});
  refused("\"Width\": 2", "\"Width\": 900000", {"numOfElems"});
  refused("\"Height\": 2", "\"Height\": 3000000", {"1000000 in a row"});
  refused("\"uint16\", \"Width\"", "\"float\", \"Width\"", {"ImageType is \"float\""});
  refused("\"elemSz\": 2", "\"elemSz\": 4", {"elemSz is not 2"});
  refused("[\"uint16\"]", "[\"int16\"]", {"elemTypes"});
  refused("[\"uint16\"]", "[]", {"elemTypes is not a list of 1"});
  refused("\"Image\"", "\"Cloud\"", {"class is \"Cloud\""});
  refused("\"z\": 0.1", "\"z\": 0", {"PixelSize.z is not above 0"});
  refused("\"x\": -10.0", "\"x\": null", {"Origin.x is not a number"});
  refused("\"x\": -10.0", "\"x\": 1e7", {"row 0, column 0", "1e6 mm"});
  refused("\"x\": -10.0", "\"x\": 1e999", {"t.json", "correct the file"});
  refused("\"z\": 0.1", "\"z\": 1e308", {"row 0, column 0", "z is infinite"});
}

TEST(SickJson, RefusesOtherJson) {
  const auto refused = [](const std::string& text, std::initializer_list<std::string_view> parts) {
    expect_input_error([&] { (void)scan_of(text); }, parts);
  };
  refused("[]", {"lists no image", "SICK"});
  refused("{}", {"no SICK image"});
  refused("[7]", {"no SICK image"});
  refused(std::string(kCameraJson), {"camera of a depth image", "give the PNG"});
  refused("[\n  {,", {"line 2, column 4: not JSON"});
  refused("[\"\xff\"]", {"not JSON"});
  refused(std::string(100'000, '['), {"nested more than 32"});
  std::string numbers = "[0";
  for (int i = 0; i < 100'001; ++i) numbers += ",0";
  refused(numbers + "]", {"more than 100000 values"});
}

TEST(SickJson, IsRefusedWhereverItIsCutOff) {
  const std::string text(kSickJson);
  for (std::size_t size = 0; size < text.size(); ++size)
    expect_input_error([&] { (void)scan_of(text.substr(0, size)); }, {"t.json", "cut off"});
}

TEST(SickJson, IsRefusedOverTheLimit) {
  expect_input_error([] { (void)read_sick_json("t", as_bytes(kSickJson), {3}); },
                     {"2 x 2", "--max-points to 4"});
}

}  // namespace
}  // namespace flatpose::port
