#pragma once
// A machine of files: a good one for real time, of which tests spoil one thing.

#include <string>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {

class MadeMachine {
 public:
  /// Eight processors, 4 to 7 the second threads of cores 0 to 3 and off, 2 and 3 isolated.
  MadeMachine() {
    set("proc/version", "Linux version 6.1.0-18-rt-amd64 (x@y) #1 SMP PREEMPT_RT Debian 6.1.76\n");
    set("sys/kernel/realtime", "1\n");
    set("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
    set("sys/devices/system/cpu/online", "0-3\n");
    set("sys/devices/system/cpu/isolated", "2-3\n");
    for (int cpu = 0; cpu < 4; ++cpu) {
      const std::string folder = "sys/devices/system/cpu/cpu" + std::to_string(cpu);
      set(folder + "/topology/thread_siblings_list", std::to_string(cpu) + "\n");
      set(folder + "/cpufreq/scaling_governor", "performance\n");
    }
    set("proc/swaps", "Filename\tType\tSize\tUsed\tPriority\n");
    set("proc/meminfo", "MemTotal:  16000000 kB\nMemAvailable:  8000000 kB\n");
    set("proc/self/status", "Name:\tflatposed\nCapEff:\t0000000000000000\n");
    set_limits("95", "unlimited");
    set("dev/cpu_dma_latency", "");
  }

  void set(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(folder_.path(file)).parent_path());
    folder_.write(file, text);
  }
  void remove(const std::string& file) const { std::filesystem::remove_all(folder_.path(file)); }
  void set_limits(const std::string& priority, const std::string& locked) const {
    set("proc/self/limits",
        "Limit                     Soft Limit           Hard Limit           Units     \n"
        "Max locked memory         " +
            locked + "    " + locked +
            "    bytes\n"
            "Max realtime priority     " +
            priority + "    " + priority +
            "\n"
            "Max realtime timeout      unlimited            unlimited            us\n");
  }
  [[nodiscard]] const std::string& root() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

}  // namespace flatpose::port
