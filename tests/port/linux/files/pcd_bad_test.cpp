// PCD files that must be refused, each with its reason and its place.
#include <gtest/gtest.h>

#include <limits>

#include "port/linux/files/pcd.hpp"
#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

void expect_refused(const std::string& bytes, std::initializer_list<std::string_view> parts,
                    const ReadLimits& limits = {}) {
  expect_input_error([&] { (void)read_pcd("t.pcd", as_bytes(bytes), limits); }, parts);
}

// A binary file whose `member` line is `value`.
std::string changed(std::string PcdLines::*member, const std::string& value) {
  PcdLines lines;
  lines.*member = value;
  return lines.text() + raw_points(small_xyz());
}

std::string ascii(const std::string& body) {
  PcdLines lines;
  lines.data = "ascii";
  return lines.text() + body;
}

std::string compressed(const std::string& body) {
  PcdLines lines;
  lines.data = "binary_compressed";
  return lines.text() + body;
}

TEST(BadPcd, IsRefusedWhenNotOrganized) {
  PcdLines lines;
  lines.width = "6";
  lines.height = "1";
  expect_refused(lines.text() + raw_points(small_xyz()),
                 {"t.pcd: 6 x 1", "save it organized (WIDTH and HEIGHT > 1)"});
}

TEST(BadPcd, NamesTheLineOfAWrongShape) {
  expect_refused(changed(&PcdLines::width, "0"), {"0 x 2", "hold nothing"});
  expect_refused(changed(&PcdLines::width, "-3"), {"line 7", "WIDTH", "-3"});
  expect_refused(changed(&PcdLines::width, "3.0"), {"line 7", "whole number"});
  expect_refused(changed(&PcdLines::width, "18446744073709551616"), {"line 7", "whole number"});
  expect_refused(changed(&PcdLines::width, "18446744073709551615"), {"1000000 in a row"});
  expect_refused(changed(&PcdLines::height, "4294967296"), {"1000000 in a row"});
  expect_refused(changed(&PcdLines::width, "3 3"), {"line 7", "one value"});
  expect_refused(changed(&PcdLines::width, ""), {"line 7", "one value"});
  expect_refused(changed(&PcdLines::points, "7"), {"line 10", "POINTS 7", "= 6"});
  expect_refused(changed(&PcdLines::points, "-6"), {"line 10", "whole number"});
}

TEST(BadPcd, IsRefusedOverTheLimit) {
  PcdLines lines;
  lines.width = "2001";
  lines.height = "2000";
  lines.points = "4002000";
  expect_refused(lines.text(), {"limit of 4000000 points", "raise --max-points to 4002000"});
  lines.width = "2000";
  lines.points = "4000000";
  expect_refused(lines.text(), {"48000000 bytes short"});
  expect_refused(changed(&PcdLines::width, "3"), {"limit of 5", "raise --max-points to 6"}, {5});
}

TEST(BadPcd, TakesNoMemoryOnTheHeadersWord) {
  PcdLines lines;
  lines.width = lines.height = "1000000";
  lines.points = "1000000000000";
  const ReadLimits all{std::numeric_limits<std::int64_t>::max(),
                       std::numeric_limits<std::int64_t>::max()};
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    lines.data = data;
    expect_refused(lines.text() + raw_points(small_xyz()), {"t.pcd"}, all);
  }
  lines.fields = "x y z big";
  lines.size = "4 4 4 8";
  lines.type = "F F F F";
  lines.count = "1 1 1 65536";
  expect_refused(lines.text() + raw_points(small_xyz()), {"t.pcd"}, all);
}

TEST(BadPcd, NamesTheLineOfWrongFields) {
  expect_refused(changed(&PcdLines::fields, "x y w"), {"line 3", "no field z"});
  expect_refused(changed(&PcdLines::fields, "x x z"), {"line 3", "second field x"});
  expect_refused(changed(&PcdLines::fields, ""), {"line 4", "more values than FIELDS"});
  expect_refused(changed(&PcdLines::size, "4 4 8"), {"line 5", "field z", "SIZE 8", "float32"});
  expect_refused(changed(&PcdLines::type, "F F I"), {"line 5", "field z", "TYPE I", "float32"});
  expect_refused(changed(&PcdLines::count, "1 2 1"), {"line 5", "field y", "COUNT 2"});
  expect_refused(changed(&PcdLines::count, "1 0 1"), {"line 6", "COUNT"});
  expect_refused(changed(&PcdLines::count, "1 -1 1"), {"line 6", "COUNT"});
  expect_refused(changed(&PcdLines::size, "4 4 3"), {"line 4", "SIZE \"3\""});
  expect_refused(changed(&PcdLines::size, "4 4"), {"line 4", "fewer"});
  expect_refused(changed(&PcdLines::size, "4 4 4 4"), {"line 4", "more"});
  expect_refused(changed(&PcdLines::type, "F F X"), {"line 5", "TYPE \"X\""});
  std::string many = "x y z";
  for (int i = 0; i < 300; ++i) many += " a";
  expect_refused(changed(&PcdLines::fields, many), {"line 4", "fewer"});
}

TEST(BadPcd, BoundsTheSizeOfAPoint) {
  PcdLines lines;
  lines.fields = "x y z a b c";
  lines.size = "4 4 4 8 8 8";
  lines.type = "F F F F F F";
  lines.count = "1 1 1 65536 65536 65536";
  expect_refused(lines.text(), {"line 3", "1048576 bytes"});
  lines.count = "1 1 1 1 1 65537";
  expect_refused(lines.text(), {"line 6", "65536"});
}

TEST(BadPcd, NamesWhatIsWrongInTheHeader) {
  const std::string good = changed(&PcdLines::width, "3");
  expect_refused(replaced(good, "VERSION 0.7", "VERSION 0.6"), {"line 2", "\"0.6\" is not 0.7"});
  expect_refused(replaced(good, "VERSION 0.7\n", ""), {"no VERSION line"});
  expect_refused(replaced(good, "WIDTH 3\n", ""), {"no WIDTH line"});
  expect_refused(replaced(good, "WIDTH 3\n", "WIDTH 3\nWIDTH 3\n"), {"line 8", "second WIDTH"});
  expect_refused(replaced(good, "WIDTH 3\n", "W\x1bTH 3\n"), {"line 7", "W\\x1bTH"});
  expect_refused(replaced(good, "DATA binary", "DATA zip"),
                 {"line 11", "\"zip\"", "ascii, binary"});
  expect_refused(changed(&PcdLines::viewpoint, "0 0 0 1 0 0"), {"line 9", "seven"});
  expect_refused(changed(&PcdLines::viewpoint, "0 0 0 1 0 0 0 0"), {"line 9", "seven"});
  expect_refused(changed(&PcdLines::viewpoint, "0 0 inf 1 0 0 0"), {"line 9", "finite"});
  expect_refused(changed(&PcdLines::viewpoint, "0 0 nan 1 0 0 0"), {"line 9", "finite"});
  expect_refused("VERSION 0.7\n" + std::string(5000, 'F') + "\n", {"line 2", "4096 bytes"});
  std::string comments = "VERSION 0.7\n";
  for (int i = 0; i < 1000; ++i) comments += "#\n";
  expect_refused(comments, {"line 201", "200"});
}

TEST(BadPcd, SaysHowManyBytesAreShort) {
  const std::string good = changed(&PcdLines::width, "3");
  expect_refused(good.substr(0, good.size() - 5), {"copy the file again: it is 5 bytes short"});
  expect_refused(good.substr(0, good.size() - 72), {"72 bytes short"});
  const std::string packed = compressed(packed_points(small_xyz()));
  expect_refused(packed.substr(0, packed.size() - 1), {"1 bytes short"});
}

TEST(BadPcd, IsRefusedWhereverItIsCutOff) {
  const std::string files[] = {changed(&PcdLines::width, "3"), ascii(small_ascii()),
                               compressed(packed_points(small_xyz()))};
  for (const std::string& good : files) {
    // An ascii number may lose its last digit unseen; two bytes less and it is missing.
    const std::size_t unseen = good.find("DATA ascii") != std::string::npos ? 4 : 1;
    for (std::size_t size = 0; size + unseen <= good.size(); ++size)
      expect_refused(good.substr(0, size), {"t.pcd"});
  }
}

TEST(BadPcd, IsRefusedWithMoreThanTheHeaderSays) {
  expect_refused(changed(&PcdLines::width, "3") + "x", {"1 bytes stand below"});
  expect_refused(ascii(small_ascii() + "1 2 3\n"), {"line 18", "more points", "= 6"});
  expect_refused(compressed(packed_points(small_xyz()) + "x"), {"bytes stand below"});
}

TEST(BadPcd, NamesThePixelThatIsNotFinite) {
  const auto with = [](std::size_t index, float value) {
    std::vector<float> xyz = small_xyz();
    xyz[index] = value;
    return xyz;
  };
  const float infinity = std::numeric_limits<float>::infinity();
  const std::string head = PcdLines{}.text();
  expect_refused(head + raw_points(with(5 * 3 + 2, infinity)),
                 {"pixel (row 1, column 2): z is infinite", "NaN"});
  expect_refused(head + raw_points(with(2 * 3, -infinity)), {"pixel (row 0, column 2): x"});
  expect_refused(head + raw_points(with(4 * 3 + 1, infinity)), {"pixel (row 1, column 1): y"});
  expect_refused(head + raw_points(with(1, 1.1e6f)), {"pixel (row 0, column 0): y", "1e6 mm"});
  expect_refused(compressed(packed_points(with(0, -3e38f))), {"pixel (row 0, column 0): x"});
  expect_refused(ascii(replaced(small_ascii(), "103", "1e39")),
                 {"row 1, column 0", "z is infinite"});
  expect_refused(ascii(replaced(small_ascii(), "103", "-inf")),
                 {"row 1, column 0", "z is infinite"});
}

TEST(BadPcd, NamesTheLineOfAWrongAsciiPoint) {
  expect_refused(ascii(replaced(small_ascii(), "102", "1O2")), {"line 14", "\"1O2\"", "number"});
  expect_refused(ascii(replaced(small_ascii(), "102", "1,02")), {"line 14", "\"1,02\""});
  expect_refused(ascii(replaced(small_ascii(), "102", "")), {"line 14", "2 numbers instead of 3"});
  expect_refused(ascii(replaced(small_ascii(), "102", "1 2")), {"line 14", "more than 3"});
  expect_refused(ascii(replaced(small_ascii(), "nan nan nan\n", "")), {"after point 5"});
}

TEST(BadPcd, IsRefusedWhenTheCompressedSizesLie) {
  const std::string good = packed_points(small_xyz());
  const auto with_size = [&](std::size_t at, std::uint32_t size) {
    std::string body = good;
    std::memcpy(body.data() + at, &size, sizeof(size));
    return compressed(body);
  };
  expect_refused(with_size(0, 0), {"cannot unpack"});
  expect_refused(with_size(0, 0xFFFFFFFF), {"bytes short"});
  expect_refused(with_size(4, 71), {"71 bytes", "72"});
  expect_refused(with_size(4, 0xFFFFFFFF), {"4294967295", "72"});
  expect_refused(compressed(""), {"8 bytes short"});
}

TEST(BadPcd, IsRefusedWhenTheCompressedDataIsDamaged) {
  const std::string good = packed_points(small_xyz());
  const std::string noise(good.size() - 8, '\xff');
  expect_refused(compressed(good.substr(0, 8) + noise), {"does not unpack to 72", "damaged"});
}

TEST(BadPcd, IsRefusedWhenItUnpacksToMoreThanAFileMayHave) {
  PcdLines lines;
  lines.width = "100";
  lines.height = "100";
  lines.points = "10000";
  lines.data = "binary_compressed";
  const std::string zeros = packed_points(std::vector<float>(30'000, 1.0f));
  EXPECT_EQ(read_pcd("t", as_bytes(lines.text() + zeros)).width_px, 100);
  expect_refused(lines.text() + zeros, {"120000 bytes", "over the limit"}, {4'000'000, 100'000});
}

}  // namespace
}  // namespace flatpose::port
