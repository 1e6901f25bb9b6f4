// What the processor is said to do, against what the kernel says of it.

#include "port/linux/cpu/vector_path.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "tests/lib/search/vector_paths.hpp"  // how a path is printed: in one way in a program

namespace flatpose::port {
namespace {

#if defined(__x86_64__)

/// The processor's flags by /proc/cpuinfo.
std::set<std::string> processor_flags() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    std::set<std::string> flags;
    for (std::string word; words >> word;) flags.insert(word);
    return flags;
  }
  return {};
}

VectorPath expected_path(const std::set<std::string>& flags) {
  if (flags.contains("avx512f") && flags.contains("avx512bw")) return VectorPath::kAvx512;
  return flags.contains("avx2") ? VectorPath::kAvx2 : VectorPath::kPortable;
}

TEST(VectorPath, IsTheWidestThatTheKernelLists) {
  const std::set<std::string> flags = processor_flags();
  if (flags.empty()) GTEST_SKIP() << "no flags in /proc/cpuinfo";
  EXPECT_EQ(best_vector_path(), expected_path(flags));
}

#elif defined(__aarch64__)

TEST(VectorPath, IsNeonOnArm) { EXPECT_EQ(best_vector_path(), VectorPath::kNeon); }

#endif

TEST(VectorPath, IsTheSameEveryTime) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(best_vector_path(), best_vector_path());
}

}  // namespace
}  // namespace flatpose::port
