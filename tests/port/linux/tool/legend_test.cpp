// What stands under a picture about its frame and heights.

#include "port/linux/tool/legend.hpp"

#include <gtest/gtest.h>

namespace flatpose::tool {
namespace {

/// 100 x 80 mm, heights from 1 to 21.5.
Relief relief() {
  Relief relief;
  relief.grid = {-50.0, -40.0, 0.5, 200, 160};
  relief.low_mm = 1.0;
  relief.high_mm = 21.5;
  return relief;
}

TEST(Legend, SaysWhichFrameTheNumbersAreIn) {
  LoadedScan loaded;
  loaded.scan.up_reason = "viewpoint";
  for (const char* const name : {"scan", "work", "robot"}) {
    EXPECT_EQ(frame_text(loaded), std::string("frame ") + name + ", seen from above (" +
                                      port::to_string(loaded.scan.up) + " by viewpoint)");
    loaded.frame = static_cast<job::FrameName>(static_cast<int>(loaded.frame) + 1);
  }
}

TEST(Legend, TellsHeightsAsZOfTheFrameWhereThatIsOneNumber) {
  const auto text = [](const Frames& frames) {
    const HeightText heights = height_text(relief(), frames);
    return heights.low + " | " + heights.high;
  };
  EXPECT_EQ(text(frames_of_scan(true)), "z 1.0 | 21.5 mm");
  EXPECT_EQ(text(frames_of_scan(false)), "z -1.0 | -21.5 mm");  // the sensor's z points down
  EXPECT_EQ(text(frames_of_work({rotation_from_vector({0.1, 0, 0}), {}})), "z 1.0 | 21.5 mm");
  // A robot's that stands upright, whichever way it is turned.
  const Pose upright{rotation_about_z(2.0), {850.0, -200.0, 300.0}};
  EXPECT_EQ(text({{}, upright}), "z 301.0 | 321.5 mm");
  // One that leans by so little that no digit shows it, and one that leans more.
  const Pose nearly{rotation_from_vector({3e-4, 0, 0}), {0.0, 0.0, 300.0}};
  EXPECT_EQ(text({{}, nearly}), "z 301.0 | 321.5 mm");
  const Pose leaning{rotation_from_vector({3e-2, 0, 0}), {0.0, 0.0, 300.0}};
  EXPECT_EQ(text({{}, leaning}), "height 1.0 | 21.5 mm");
}

}  // namespace
}  // namespace flatpose::tool
