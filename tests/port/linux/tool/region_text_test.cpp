#include "port/linux/tool/region_text.hpp"

#include <gtest/gtest.h>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::tool {
namespace {

TEST(RegionText, CircleHoldsItsBorderAndNoMore) {
  const Region region = parse_region("--region", "circle:-4,77.2,66");
  EXPECT_EQ(region.kind, Region::Kind::kCircle);
  EXPECT_TRUE(region.contains(-4.0, 77.2 + 66.0));
  EXPECT_FALSE(region.contains(-4.0, 77.2 + 66.01));
}

TEST(RegionText, BoxTakesItsCornersInAnyOrder) {
  for (const char* text : {"box:1,2,5,8", "box:5,8,1,2", "box:5,2,1,8"}) {
    const Region region = parse_region("--region", text);
    EXPECT_TRUE(region.contains(1.0, 2.0)) << text;
    EXPECT_TRUE(region.contains(5.0, 8.0)) << text;
    EXPECT_FALSE(region.contains(5.1, 8.0)) << text;
  }
}

TEST(RegionText, PolygonOfAnyKeepsItsCorners) {
  const Region region = parse_region("--region", "polygon:0,0;10,0;0,10");
  EXPECT_EQ(region.vertex_count, 3);
  EXPECT_TRUE(region.contains(2.0, 2.0));
  EXPECT_FALSE(region.contains(8.0, 8.0));
}

TEST(RegionText, PolygonMayHaveSixtyFourCornersButNoMore) {
  std::string text = "polygon:0,0";
  for (int i = 1; i < 64; ++i) text += ";" + std::to_string(i) + "," + std::to_string(i * i);
  EXPECT_EQ(parse_region("--region", text).vertex_count, 64);
  port::expect_input_error([&] { (void)parse_region("--region", text + ";100,0"); },
                           {"--region", "65 corners", "64"});
}

TEST(RegionText, WhatIsNoRegionIsRefusedInOneLine) {
  for (const char* text : {"",
                           "circle",
                           "circle:",
                           "circle:1,2",
                           "circle:1,2,3,4",
                           "circle:1,2,0",
                           "circle:1,2,-3",
                           "circle:1,2,nan",
                           "circle:inf,2,3",
                           "circle:1e9,2,3",
                           "circle:1,2,3 ",
                           "circle: 1,2,3",
                           "circle:1,2,0x10",
                           "circle:+1,2,3",
                           "circle:1,,3",
                           "Circle:1,2,3",
                           "box:1,2,3",
                           "box:1,2,1,8",
                           "box:1,2,5,2",
                           "polygon:",
                           "polygon:0,0;1,1",
                           "polygon:0,0;1,1;2,2",
                           "polygon:0,0;5,0;0,0",
                           "polygon:0,0;1,0;0",
                           "polygon:0,0;1,0;0,1;",
                           "square:1,2,3",
                           "circle:1,2,3\n"}) {
    port::expect_input_error([&] { (void)parse_region("--region", text); }, {"--region"});
  }
}

}  // namespace
}  // namespace flatpose::tool
