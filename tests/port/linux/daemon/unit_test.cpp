// The unit file grants what [realtime] can ask for.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

namespace {

std::vector<std::string> lines_of_unit() {
  std::ifstream file(FLATPOSE_SOURCE_DIR "/port/linux/systemd/flatposed.service");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

bool has(const std::string& wanted) {
  for (const std::string& line : lines_of_unit())
    if (line == wanted) return true;
  return false;
}

TEST(Unit, GrantsWhatRealTimeAsksFor) {
  EXPECT_TRUE(has("LimitRTPRIO=90"));
  EXPECT_TRUE(has("LimitMEMLOCK=infinity"));
  EXPECT_TRUE(has("DeviceAllow=/dev/cpu_dma_latency rw"));
  EXPECT_FALSE(has("RestrictRealtime=yes"));
  EXPECT_FALSE(has("PrivateDevices=yes"));
}

}  // namespace
