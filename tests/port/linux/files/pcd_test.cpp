#include "port/linux/files/pcd.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/port/linux/files/made_files.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

Scan scan_of(const std::string& bytes) { return read_pcd("t.pcd", as_bytes(bytes)); }

void expect_small(const Scan& scan) {
  ASSERT_EQ(scan.width_px, 3);
  ASSERT_EQ(scan.height_px, 2);
  const std::vector<float> expected = small_xyz();
  ASSERT_EQ(scan.xyz_mm.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (std::isnan(expected[i])) {
      EXPECT_TRUE(std::isnan(scan.xyz_mm[i])) << i;
    } else {
      EXPECT_EQ(scan.xyz_mm[i], expected[i]) << i;
    }
  }
}

std::string with_data(PcdLines lines, const std::string& data, const std::string& body) {
  lines.data = data;
  return lines.text() + body;
}

TEST(Pcd, ReadsAscii) { expect_small(scan_of(with_data({}, "ascii", small_ascii()))); }
TEST(Pcd, ReadsBinary) { expect_small(scan_of(with_data({}, "binary", raw_points(small_xyz())))); }
TEST(Pcd, ReadsCompressed) {
  expect_small(scan_of(with_data({}, "binary_compressed", packed_points(small_xyz()))));
}

TEST(Pcd, SkipsOtherFieldsInAscii) {
  std::string body;
  const std::vector<float> xyz = small_xyz();
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    body += "4294967295 " + std::to_string(xyz[i + 1]) + " 1 2 3 4 5\t" + std::to_string(xyz[i]) +
            "  inf nan -inf +" + std::to_string(std::fabs(xyz[i + 2])) + " 1e300 \r\n\n";
  expect_small(scan_of(with_data(mixed_lines(), "ascii", body)));
}

TEST(Pcd, SkipsOtherFieldsInBinary) {
  expect_small(scan_of(with_data(mixed_lines(), "binary", mixed_points(small_xyz()))));
}

TEST(Pcd, SkipsOtherFieldsInCompressed) {
  PcdLines lines;
  lines.fields = "label z y curvature x";
  lines.size = "1 4 4 8 4";
  lines.type = "I F F F F";
  lines.count = "3 1 1 2 1";
  const std::vector<float> xyz = small_xyz();
  std::string plain(6 * 3, 'l');
  for (std::size_t i = 2; i < xyz.size(); i += 3) append_raw(plain, xyz[i]);
  for (std::size_t i = 1; i < xyz.size(); i += 3) append_raw(plain, xyz[i]);
  plain.append(6 * 16, 'c');
  for (std::size_t i = 0; i < xyz.size(); i += 3) append_raw(plain, xyz[i]);
  expect_small(scan_of(with_data(lines, "binary_compressed", packed_by_lzf(plain))));
}

TEST(Pcd, TakesTheLinesThatTheFormatLetsAway) {
  std::string text = with_data({}, "binary", raw_points(small_xyz()));
  text = replaced(text, "COUNT 1 1 1\n", "");
  text = replaced(text, "POINTS 6\n", "# a comment\n\n");
  text = replaced(text, "VIEWPOINT 0 0 0 1 0 0 0\n", "");
  text = replaced(text, "VERSION 0.7\n", "VERSION .7\r\n");
  expect_small(scan_of(text));
  expect_small(scan_of(replaced(text, "# .PCD v0.7 - Point Cloud Data file format\n", "")));
}

TEST(Pcd, TakesPaddingBelowThePoints) {
  const std::string padding("\0\0\n\0", 4);
  expect_small(scan_of(with_data({}, "binary", raw_points(small_xyz()) + padding)));
  expect_small(scan_of(with_data({}, "binary_compressed", packed_points(small_xyz()) + padding)));
}

TEST(Pcd, ViewIsTheGrid) {
  const Scan scan = scan_of(with_data({}, "binary", raw_points(small_xyz())));
  const RangeImageView view = scan.view();
  EXPECT_EQ(view.width_px, 3);
  EXPECT_EQ(view.height_px, 2);
  EXPECT_EQ(view(2, 1), (Vec3{0.0, 0.25, 105.0}));
  EXPECT_FALSE(is_valid(view(1, 1)));
}

// Valid z: 100, 101, 102, 103, 105: the median is 102.
TEST(Pcd, UpIsWhereTheViewpointLies) {
  const auto up_of = [](const std::string& viewpoint_z) {
    PcdLines lines;
    lines.viewpoint = "1 2 " + viewpoint_z + " 1 0 0 0";
    const Scan scan = scan_of(with_data(lines, "binary", raw_points(small_xyz())));
    EXPECT_EQ(scan.up_reason, "viewpoint");
    return std::string(to_string(scan.up));
  };
  EXPECT_EQ(up_of("0"), "-z");
  EXPECT_EQ(up_of("101.9"), "-z");
  EXPECT_EQ(up_of("102"), "-z");
  EXPECT_EQ(up_of("102.1"), "+z");
  EXPECT_EQ(up_of("1e3"), "+z");
}

TEST(Pcd, UpIsTheDefaultWhenAllIsMissing) {
  const Scan scan = scan_of(with_data({}, "binary", raw_points(std::vector<float>(18, kMissing))));
  EXPECT_EQ(scan.up, Up::kMinusZ);
  EXPECT_EQ(scan.up_reason, "default");
}

TEST(Pcd, WhatIsWrittenReadsBackBitByBit) {
  const TemporaryFolder folder;
  const Scan scan = scan_of(with_data(mixed_lines(), "binary", mixed_points(small_xyz())));
  const Vec3 viewpoint_mm{0.1, -1e-9, 512.25};
  write_pcd(folder.path("o.pcd"), scan.view(), viewpoint_mm);
  const Scan back = read_scan(folder.path("o.pcd"));
  expect_small(back);
  EXPECT_EQ(back.viewpoint_mm, viewpoint_mm);
  EXPECT_EQ(back.up, Up::kPlusZ);
  EXPECT_EQ(pcd_bytes(back.view(), viewpoint_mm), pcd_bytes(scan.view(), viewpoint_mm));
}

TEST(Pcd, SaysOfASimulatedScanThatItIsOne) {
  const TemporaryFolder folder;
  const Scan scan = scan_of(with_data(mixed_lines(), "binary", mixed_points(small_xyz())));
  EXPECT_FALSE(scan.is_simulated);
  for (const bool is_simulated : {false, true}) {
    write_pcd(folder.path("o.pcd"), scan.view(), {}, is_simulated);
    const Scan back = read_scan(folder.path("o.pcd"));
    EXPECT_EQ(back.is_simulated, is_simulated);
    expect_small(back);
  }
  const std::string foreign = "# flatpose: simulated by nobody\n";
  EXPECT_FALSE(scan_of(foreign + with_data({}, "ascii", small_ascii())).is_simulated);
}

TEST(Pcd, WritesFromPlanesWithStrides) {
  const std::vector<float> x{1, 2, 9, 3, 4, 9}, y{5, 6, 9, 7, 8, 9}, z{10, 11, 9, 12, 13, 9};
  const RangeImageView planes{x.data(), y.data(), z.data(), 2, 2, 4, 12};
  const std::vector<std::byte> bytes = pcd_bytes(planes, {});
  const Scan scan = read_pcd("t", bytes);
  EXPECT_EQ(scan.xyz_mm, (std::vector<float>{1, 5, 10, 2, 6, 11, 3, 7, 12, 4, 8, 13}));
}

TEST(ReadScan, TakesTheOptionOverTheFile) {
  const TemporaryFolder folder;
  const std::string path = folder.write("t", with_data({}, "ascii", small_ascii()));
  EXPECT_EQ(read_scan(path).up, Up::kMinusZ);
  const Scan scan = read_scan(path, {}, Up::kPlusZ);
  EXPECT_EQ(scan.up, Up::kPlusZ);
  EXPECT_EQ(scan.up_reason, "option");
  EXPECT_EQ(parse_up("+z"), Up::kPlusZ);
  EXPECT_EQ(parse_up("-z"), Up::kMinusZ);
  EXPECT_FALSE(parse_up("z"));
}

TEST(ReadScan, GoesByContentNotByName) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_scan(folder.write("scan.png", with_data({}, "ascii", small_ascii()))).width_px, 3);
  EXPECT_EQ(read_scan(folder.write("scan.pcd", kSickJson)).width_px, 2);
  const std::string other_comment = replaced(with_data({}, "ascii", small_ascii()), ".PCD", "a");
  EXPECT_EQ(read_scan(folder.write("scan", "#\n" + other_comment)).width_px, 3);
  expect_input_error([&] { (void)read_scan(folder.write("a.pcd", "#!/bin/sh\n")); },
                     {"#!/bin/s", "organized PCD"});
  expect_input_error([&] { (void)read_scan(folder.write("a.pcd", "ply\nformat")); },
                     {"ply\\x0aform", "organized PCD"});
  expect_input_error([&] { (void)read_scan(folder.write("a.pcd", "")); }, {"it is empty"});
  expect_input_error([&] { (void)read_scan(folder.path("none.pcd")); }, {"No such file"});
}

}  // namespace
}  // namespace flatpose::port
