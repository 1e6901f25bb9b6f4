// Scans of real sensors: the folder FLATPOSE_REAL_DATA, skipped without it (an error in CI).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/pcd.hpp"
#include "port/linux/files/scan.hpp"

namespace flatpose::port {
namespace {

class RealScan : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("FLATPOSE_REAL_DATA");
    folder_ = folder != nullptr ? folder : FLATPOSE_REAL_DATA_DEFAULT;
    if (std::filesystem::is_directory(folder_)) return;
    if (std::getenv("CI") != nullptr) FAIL() << folder_ << " is missing";
    GTEST_SKIP() << folder_ << " is missing";
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string folder_;
};

std::size_t valid_count(const Scan& scan) {
  std::size_t count = 0;
  for (int row = 0; row < scan.height_px; ++row)
    for (int column = 0; column < scan.width_px; ++column)
      count += is_valid(scan.view()(column, row));
  return count;
}

TEST_F(RealScan, PcdsAreReadAndLookAlongZ) {
  const struct {
    const char* name;
    int width_px, height_px;
  } scans[] = {{"sick_disc/disc_teach.pcd", 800, 704},
               {"sick_disc/disc_match.pcd", 800, 704},
               {"sick_shapes/shapes.pcd", 744, 770}};
  for (const auto& expected : scans) {
    const Scan scan = read_scan(path(expected.name));
    EXPECT_EQ(scan.width_px, expected.width_px);
    EXPECT_EQ(scan.height_px, expected.height_px);
    EXPECT_EQ(scan.up, Up::kMinusZ);
    EXPECT_EQ(scan.up_reason, "viewpoint");
    EXPECT_GT(valid_count(scan), scan.view().size() / 2);
  }
}

// x = -73.94 + 0.21585 column, y = 0.20882 row, as measured from the cloud.
TEST_F(RealScan, ShapesLieOnTheirMeasuredGrid) {
  const Scan scan = read_scan(path("sick_shapes/shapes.pcd"));
  for (int row = 0; row < scan.height_px; row += 7) {
    for (int column = 0; column < scan.width_px; column += 7) {
      const Vec3 p = scan.view()(column, row);
      if (!is_valid(p)) continue;
      ASSERT_NEAR(p.x, -73.94 + 0.21585 * column, 0.02);
      ASSERT_NEAR(p.y, 0.20882 * row, 0.02);
    }
  }
}

TEST_F(RealScan, PcdIsWrittenBackAsItWas) {
  const std::string file = path("sick_disc/disc_teach.pcd");
  const Scan scan = read_scan(file);
  EXPECT_EQ(pcd_bytes(scan.view(), *scan.viewpoint_mm), read_file(file, 1 << 30));
}

TEST_F(RealScan, HeightMapsOfBothByteOrdersAreTheListedPoints) {
  const Scan little = read_scan(path("sick_json/crop_little.json"));
  const Scan big = read_scan(path("sick_json/crop_big.json"));
  ASSERT_EQ(little.width_px, 20);
  ASSERT_EQ(little.height_px, 10);
  ASSERT_EQ(big.view().size(), little.view().size());
  EXPECT_EQ(little.up, Up::kPlusZ);
  std::ifstream csv(path("sick_json/crop_expected.csv"));
  std::string line;
  std::getline(csv, line);
  int count = 0;
  for (; std::getline(csv, line); ++count) {
    int column = 0, row = 0;
    char x[32], y[32], z[32];
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%d,%31[^,],%31[^,],%31s", &column, &row, x, y, z), 5);
    for (const Scan* scan : {&little, &big}) {
      const Vec3 p = scan->view()(column, row);
      EXPECT_NEAR(p.x, std::atof(x), 1e-5);
      EXPECT_NEAR(p.y, std::atof(y), 1e-5);
      if (std::isnan(std::atof(z))) {
        EXPECT_TRUE(std::isnan(p.z)) << line;
      } else {
        EXPECT_NEAR(p.z, std::atof(z), 1e-5) << line;
      }
    }
  }
  EXPECT_EQ(count, 200);
}

}  // namespace
}  // namespace flatpose::port
