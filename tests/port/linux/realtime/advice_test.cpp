#include "port/linux/realtime/advice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/port/linux/realtime/made_machine.hpp"

namespace flatpose::port {
namespace {

constexpr std::int64_t kMb = 1024 * 1024;

RealtimeConfig wanted() {
  RealtimeConfig config;
  config.cpus = {2, 3};
  config.priority = 80;
  config.lock_memory = true;
  config.cpu_latency_us = 0;
  return config;
}

std::vector<Advice> advice_for(const MadeMachine& machine,
                               const RealtimeConfig& config = wanted()) {
  return advise(read_machine(machine.root()), config, 2, 300 * kMb);
}

/// The one thing that is missing, by its name, and what must stand in its command.
void expect_only(const std::vector<Advice>& list, const std::string& what,
                 const std::string& command) {
  ASSERT_EQ(list.size(), 1U) << (list.size() > 1 ? list[1].what + ": " + list[1].why : "");
  EXPECT_EQ(list[0].what, what);
  EXPECT_FALSE(list[0].why.empty());
  EXPECT_NE(list[0].command.find(command), std::string::npos) << list[0].command;
}

/// The same after one that is not isolated.
void expect_last(std::vector<Advice> list, const std::string& what, const std::string& command) {
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].what, "isolation");
  list.erase(list.begin());
  expect_only(list, what, command);
}

TEST(Advice, IsNotNeededByAGoodMachine) {
  const MadeMachine machine;
  for (const Advice& advice : advice_for(machine)) ADD_FAILURE() << advice.what << advice.why;
}

TEST(Advice, NamesAnOrdinaryKernel) {
  const MadeMachine machine;
  machine.remove("sys/kernel/realtime");
  EXPECT_TRUE(advice_for(machine).empty());  // its version still says PREEMPT_RT
  machine.set("proc/version", "Linux version 6.1.0-18-amd64 (x@y) #1 SMP PREEMPT_DYNAMIC\n");
  expect_only(advice_for(machine), "kernel", "apt install linux-image-rt-");
}

TEST(Advice, NamesLimitsUnlessACapabilityLiftsThem) {
  const MadeMachine machine;
  machine.set_limits("79", "unlimited");
  expect_only(advice_for(machine), "priority", "rtprio 80");
  machine.set("proc/self/status", "CapEff:\t0000000000800000\n");
  EXPECT_TRUE(advice_for(machine).empty());
  machine.set_limits("79", std::to_string(299 * kMb));
  expect_only(advice_for(machine), "memory lock", "memlock unlimited");
  machine.set("proc/self/status", "CapEff:\t0000000000804000\n");
  EXPECT_TRUE(advice_for(machine).empty());
  machine.set("proc/self/status", "CapEff:\t0000000000000000\n");
  machine.set_limits("80", std::to_string(300 * kMb));
  EXPECT_TRUE(advice_for(machine).empty());
}

TEST(Advice, NamesGovernorsOfTheCpusThatSearchOnly) {
  const MadeMachine machine;
  machine.set("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
  EXPECT_TRUE(advice_for(machine).empty());
  machine.set("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "powersave\n");
  expect_only(advice_for(machine), "governor", "for i in 3; do echo performance");
  machine.remove("sys/devices/system/cpu/cpu3/cpufreq");
  EXPECT_TRUE(advice_for(machine).empty());
}

TEST(Advice, NamesThrottlingAsTheKernelDoesIt) {
  const MadeMachine machine;
  machine.set("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  expect_only(advice_for(machine), "throttling", "sysctl -w kernel.sched_rt_runtime_us=-1");
  machine.set("proc/version", "Linux version 6.12.1-rt (x@y) #1 SMP PREEMPT_RT\n");
  EXPECT_TRUE(advice_for(machine).empty());  // void there
  machine.set("sys/kernel/debug/sched/fair_server/cpu3/runtime", "50000000\n");
  EXPECT_TRUE(advice_for(machine).empty());  // isolated: no ordinary work waits there
  machine.set("sys/devices/system/cpu/isolated", "2\n");
  expect_last(advice_for(machine), "throttling", "for i in 3; do echo 0");
  machine.remove("sys/kernel/debug");  // where only root may look: the kernel's usual
  expect_last(advice_for(machine), "throttling", "for i in 3; do echo 0");
  machine.set("sys/kernel/debug/sched/fair_server/cpu3/runtime", "0\n");
  expect_only(advice_for(machine), "isolation", "isolcpus=3");
}

TEST(Advice, NamesCpusThatAreNotIsolated) {
  const MadeMachine machine;
  machine.set("sys/devices/system/cpu/isolated", "2\n");
  expect_only(advice_for(machine), "isolation", "isolcpus=3 nohz_full=3 rcu_nocbs=3");
  machine.set("sys/devices/system/cpu/isolated", "\n");
  expect_only(advice_for(machine), "isolation", "isolcpus=2-3");
}

TEST(Advice, IsolatesNeverAllCpus) {
  const MadeMachine machine;
  machine.set("sys/devices/system/cpu/online", "2-3\n");
  EXPECT_TRUE(advice_for(machine).empty());
  machine.set("sys/devices/system/cpu/isolated", "\n");
  expect_only(advice_for(machine), "isolation", "one less of each");
}

TEST(Advice, NamesCpusThatAreMissingOrNotGiven) {
  const MadeMachine machine;
  RealtimeConfig config = wanted();
  config.cpus = {2, 7};
  expect_only(advice_for(machine, config), "cpus", "cpus = [2, 3]");
  config.cpus = {};
  expect_only(advice_for(machine, config), "cpus", "cpus = [2, 3]");
  machine.set("sys/devices/system/cpu/online", "3\n");
  config.cpus = {3};
  expect_only(advice_for(machine, config), "threads", "threads = 1");
}

TEST(Advice, NamesSharedCores) {
  const MadeMachine machine;
  machine.set("sys/devices/system/cpu/cpu3/topology/thread_siblings_list", "1,3\n");
  expect_only(advice_for(machine), "cores", "for i in 1; do echo 0");
  machine.set("sys/devices/system/cpu/cpu3/topology/thread_siblings_list", "2-3\n");
  expect_only(advice_for(machine), "cores", "lscpu");
  machine.set("sys/devices/system/cpu/cpu3/topology/thread_siblings_list", "3,7\n");
  EXPECT_TRUE(advice_for(machine).empty());  // 7 is off
}

TEST(Advice, NamesSwapMemoryAndIdleStates) {
  const MadeMachine machine;
  machine.set("proc/swaps", "Filename Type Size Used Priority\n/dev/sda2 partition 1 0 -2\n");
  expect_only(advice_for(machine), "swap", "swapoff -a");
  machine.set("proc/swaps", "Filename Type Size Used Priority\n");
  machine.set("proc/meminfo", "MemAvailable:  " + std::to_string(300 * 1024 - 1) + " kB\n");
  expect_only(advice_for(machine), "memory", "cell_count");
  machine.set("proc/meminfo", "MemAvailable:  " + std::to_string(300 * 1024) + " kB\n");
  machine.remove("dev/cpu_dma_latency");
  expect_only(advice_for(machine), "idle states", "cpu_dma_latency");
  RealtimeConfig config = wanted();
  config.cpu_latency_us.reset();
  EXPECT_TRUE(advice_for(machine, config).empty());
}

TEST(Advice, IsSilentAboutAMachineOfWhichNothingIsKnown) {
  const TemporaryFolder folder;
  RealtimeConfig config = wanted();
  config.cpu_latency_us.reset();
  EXPECT_TRUE(advise(read_machine(folder.path()), config, 2, 300 * kMb).empty());
}

TEST(Machine, TakesAnyFilesForWhatTheyAre) {
  const MadeMachine machine;
  const std::vector<std::string> files{"proc/version",
                                       "proc/self/status",
                                       "proc/self/limits",
                                       "proc/swaps",
                                       "proc/meminfo",
                                       "proc/sys/kernel/sched_rt_runtime_us",
                                       "sys/devices/system/cpu/online",
                                       "sys/devices/system/cpu/isolated",
                                       "sys/devices/system/cpu/cpu3/topology/thread_siblings_list"};
  std::mt19937 random(7);
  const std::string letters = "0123456789-,:\n \tMaxCapEffk\xff";
  for (int i = 0; i < 300; ++i) {
    std::string text = i % 2 == 0 ? "" : "CapEff: Max locked memory MemAvailable: ";
    for (std::size_t n = random() % 40; n > 0; --n) text += letters[random() % letters.size()];
    machine.set(files[random() % files.size()], text);
    for (const Advice& advice : advice_for(machine)) {
      EXPECT_FALSE(advice.what.empty() || advice.why.empty() || advice.command.empty());
    }
  }
}

TEST(Machine, ThatRunsTheTestsIsRead) {
  const Machine machine = read_machine();
  EXPECT_FALSE(machine.kernel.empty());
  EXPECT_FALSE(machine.online.empty());
  EXPECT_GT(machine.memory_available_bytes.value_or(0), kMb);
  EXPECT_TRUE(machine.priority_limit && machine.locked_limit_bytes);
}

}  // namespace
}  // namespace flatpose::port
