// The set-up, held against what the kernel says of the thread afterwards. What this machine does
// not allow must be said, not done.

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include "port/linux/realtime/background_thread.hpp"
#include "port/linux/realtime/memory.hpp"
#include "port/linux/realtime/process_setup.hpp"
#include "port/linux/realtime/thread_setup.hpp"
#include "tests/port/linux/realtime/made_machine.hpp"

namespace flatpose::port {
namespace {

std::vector<int> allowed_cpus() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> cpus;
  for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) cpus.push_back(static_cast<int>(cpu));
  return cpus;
}

/// In a thread of its own, so that the test's stays as it is.
template <class Body>
void on_a_thread(const Body& body) {
  std::thread(body).join();
}

TEST(ThreadSetup, DoesNothingUnasked) {
  on_a_thread([] {
    const std::vector<int> cpus = allowed_cpus();
    EXPECT_TRUE(set_up_this_thread({}, 0, "search 0").empty());
    EXPECT_EQ(allowed_cpus(), cpus);
    EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  });
}

TEST(ThreadSetup, PinsThreadByThread) {
  const std::vector<int> cpus = allowed_cpus();
  for (int index = 0; index < static_cast<int>(cpus.size()); ++index) {
    on_a_thread([&] {
      RealtimeConfig config;
      config.cpus = cpus;
      const Steps steps = set_up_this_thread(config, index, "search");
      ASSERT_EQ(steps.size(), 1U);
      EXPECT_TRUE(steps[0].is_done) << line_of(steps[0]);
      EXPECT_EQ(allowed_cpus(), std::vector<int>{cpus[static_cast<std::size_t>(index)]});
    });
  }
}

TEST(ThreadSetup, SaysWhichCpuIsNone) {
  for (const int cpu : {1023, 100'000, -1}) {
    on_a_thread([&] {
      RealtimeConfig config;
      config.cpus = {cpu};
      const Steps steps = set_up_this_thread(config, 0, "search");
      ASSERT_EQ(steps.size(), 1U);
      EXPECT_FALSE(steps[0].is_done);
      expect_one_line(line_of(steps[0]));
      EXPECT_NE(line_of(steps[0]).find("CPU " + std::to_string(cpu)), std::string::npos);
    });
  }
}

TEST(ThreadSetup, SetsTimerSlackAndName) {
  on_a_thread([] {
    RealtimeConfig config;
    config.timer_slack_ns = 1234;
    const Steps steps = set_up_this_thread(config, 0, "a name longer than fifteen");
    ASSERT_EQ(steps.size(), 1U);
    EXPECT_TRUE(steps[0].is_done);
    EXPECT_EQ(prctl(PR_GET_TIMERSLACK), 1234);
    char name[16] = {};
    prctl(PR_GET_NAME, name);
    EXPECT_STREQ(name, "a name longer t");
    config.timer_slack_ns = 0;
    EXPECT_TRUE(set_up_this_thread(config, 0, "x")[0].is_done);
    EXPECT_EQ(prctl(PR_GET_TIMERSLACK), 1);
  });
}

TEST(ThreadSetup, SaysTruthAboutPriority) {
  on_a_thread([] {
    RealtimeConfig config;
    config.priority = 7;
    const Steps steps = set_up_this_thread(config, 0, "search");
    ASSERT_EQ(steps.size(), 1U);
    sched_param param{};
    sched_getparam(0, &param);
    EXPECT_EQ(steps[0].is_done, sched_getscheduler(0) == SCHED_FIFO);
    EXPECT_EQ(steps[0].is_done, param.sched_priority == 7);
  });
}

/// 0 when an unprivileged process is told of everything that it may not do.
int refusals_as_nobody() {
  if (geteuid() == 0 && setuid(65534) != 0) return 10;
  rlimit none{0, 0};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &none) != 0) return 11;
  RealtimeConfig config;
  config.priority = 7;
  const Steps steps = set_up_this_thread(config, 0, "search");
  if (steps.size() != 1 || steps[0].is_done) return 1;
  return line_of(steps[0]).find("LimitRTPRIO=7") == std::string::npos ? 2 : 0;
}

TEST(ThreadSetup, NamesTheRightThatIsMissing) {
  EXPECT_EXIT(_exit(refusals_as_nobody()), testing::ExitedWithCode(0), "");
}

TEST(CpuLatency, IsWrittenAndHeldOpen) {
  const MadeMachine machine;
  RealtimeConfig config;
  config.cpu_latency_us = 0x01020304;
  const ProcessSetup setup(config, machine.root());
  ASSERT_EQ(setup.steps().size(), 1U);
  EXPECT_TRUE(setup.steps()[0].is_done) << line_of(setup.steps()[0]);
  std::ifstream file(machine.root() + "/dev/cpu_dma_latency", std::ios::binary);
  std::int32_t value = 0;
  file.read(reinterpret_cast<char*>(&value), sizeof value);
  EXPECT_EQ(value, 0x01020304);
}

TEST(CpuLatency, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  RealtimeConfig config;
  config.cpu_latency_us = 20;
  const ProcessSetup setup(config, folder.path());
  ASSERT_EQ(setup.steps().size(), 1U);
  EXPECT_FALSE(setup.steps()[0].is_done);
  expect_one_line(line_of(setup.steps()[0]));
  EXPECT_NE(line_of(setup.steps()[0]).find("/dev/cpu_dma_latency"), std::string::npos);
}

TEST(RealtimeConfig, WantsACpuForEachThread) {
  RealtimeConfig config;
  EXPECT_EQ(problem_with(config, 8), "");
  config.cpus = {2, 3};
  EXPECT_EQ(problem_with(config, 2), "");
  EXPECT_NE(problem_with(config, 3), "");
  config.cpus = {2, 2};
  EXPECT_NE(problem_with(config, 2), "");
  config.cpus = {};
  for (const auto& [priority, is_right] :
       {std::pair{-1, false}, {0, true}, {1, true}, {99, true}, {100, false}}) {
    config.priority = priority;
    EXPECT_EQ(problem_with(config, 1).empty(), is_right) << priority;
  }
}

TEST(PrefaultedMemory, IsThereAndEmpty) {
  PrefaultedMemory memory(1'000'000);
  EXPECT_EQ(memory.span().size(), 1'000'000U);
  for (const std::byte byte : memory.span()) ASSERT_EQ(byte, std::byte{0});
  EXPECT_TRUE(PrefaultedMemory(0).span().empty());
  EXPECT_THROW(PrefaultedMemory(std::size_t{1} << 60), std::bad_alloc);
}

TEST(BackgroundThread, MakesRoomAndKeepsOffTheSearchsCpus) {
  cpu_set_t all;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  int first = 0;
  while (!CPU_ISSET(static_cast<unsigned>(first), &all)) ++first;
  RealtimeConfig config;
  config.cpus = {first};
  Steps steps;
  cpu_set_t kept;
  int nice = 0;
  std::thread([&] {
    steps = set_up_background_thread(config, "test");
    sched_getaffinity(0, sizeof kept, &kept);
    nice = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
  }).join();
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_TRUE(steps[0].is_done) << line_of(steps[0]);
  EXPECT_EQ(nice, 19);
  const bool has_another = CPU_COUNT(&all) > 1;  // else there is nowhere to go, and it says so
  EXPECT_EQ(steps[1].is_done, has_another) << line_of(steps[1]);
  EXPECT_EQ(CPU_ISSET(static_cast<unsigned>(first), &kept) == 0, has_another);
}

}  // namespace
}  // namespace flatpose::port
