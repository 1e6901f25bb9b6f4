// The unit file grants what the config can ask for.

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

TEST(Unit, MakesTheFolderOfTheCamerasSocket) {
  EXPECT_TRUE(has("RuntimeDirectory=flatpose"));
  EXPECT_TRUE(has("RuntimeDirectoryMode=0750"));  // the group's: the driver's user belongs to it
  bool may_use_unix = false;
  for (const std::string& line : lines_of_unit())
    may_use_unix = may_use_unix || line.rfind("RestrictAddressFamilies=AF_UNIX ", 0) == 0;
  EXPECT_TRUE(may_use_unix);
}

TEST(Unit, ReloadsJobsBySighup) { EXPECT_TRUE(has("ExecReload=/bin/kill -HUP $MAINPID")); }

}  // namespace
