#include "port/linux/records/boot_count.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

struct BootCount : testing::Test {
  std::uint16_t boot(const std::string& name = "state.json") {
    return count_boot(folder.path(name),
                      [&](const std::string& line) { warnings.push_back(line); });
  }
  TemporaryFolder folder;
  std::vector<std::string> warnings;
};

TEST_F(BootCount, CountsUpFromOne) {
  for (std::uint16_t start = 1; start <= 5; ++start) EXPECT_EQ(boot(), start);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST_F(BootCount, GoesOnWithOneAfterTheLast) {
  folder.write("state.json", "{\"boot_count\": 65534}");
  EXPECT_EQ(boot(), 65535);
  EXPECT_EQ(boot(), 1);
  EXPECT_TRUE(warnings.empty());
}

TEST_F(BootCount, StartsAnewWithAWarningWhenTheFileIsDamaged) {
  for (const char* const text :
       {"", "{", "[]", "{\"boot_count\": 65536}", "{\"boot_count\": -1}", "{\"boot_count\": \"3\"}",
        "{\"boot_count\": 1.5}", "{\"boots\": 3}", "\x00\xff\xfe"}) {
    warnings.clear();
    folder.write("state.json", text);
    EXPECT_EQ(boot(), 1) << text;
    ASSERT_EQ(warnings.size(), 1U) << text;
    EXPECT_NE(warnings[0].find("counted anew"), std::string::npos) << warnings[0];
    EXPECT_EQ(boot(), 2) << text;
  }
}

TEST_F(BootCount, IsNoneWhenItCannotBeWrittenDown) {
  EXPECT_EQ(boot("no/state.json"), 0);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("not counted"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace flatpose::port
