#include "port/linux/realtime/cpu_list.hpp"

#include <gtest/gtest.h>

namespace flatpose::port {
namespace {

using Cpus = std::vector<int>;

TEST(CpuList, IsReadAsTheKernelWritesIt) {
  EXPECT_EQ(parse_cpu_list(""), Cpus{});
  EXPECT_EQ(parse_cpu_list("\n"), Cpus{});
  EXPECT_EQ(parse_cpu_list("0\n"), Cpus{0});
  EXPECT_EQ(parse_cpu_list("0-3,5\n"), (Cpus{0, 1, 2, 3, 5}));
  EXPECT_EQ(parse_cpu_list("5,2-3,3"), (Cpus{2, 3, 5}));
}

TEST(CpuList, LeavesOutWhatIsNone) {
  EXPECT_EQ(parse_cpu_list("x,1,-2,3-,4-x,6-5,7"), (Cpus{1, 7}));
  EXPECT_EQ(parse_cpu_list("0-4000000000,99999,8"), Cpus{8});
}

TEST(CpuList, IsWrittenInTheShortestForm) {
  EXPECT_EQ(to_cpu_list({}), "");
  EXPECT_EQ(to_cpu_list({5, 1, 2, 3}), "1-3,5");
  for (unsigned mask = 0; mask < 1024; ++mask) {
    Cpus cpus;
    for (int cpu = 0; cpu < 10; ++cpu)
      if ((mask >> cpu & 1) != 0) cpus.push_back(cpu);
    EXPECT_EQ(parse_cpu_list(to_cpu_list(cpus)), cpus);
  }
}

}  // namespace
}  // namespace flatpose::port
