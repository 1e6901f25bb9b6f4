#pragma once
// What this machine is and allows, as far as it decides how certain a search's time is. Read from
// /proc, /sys and /dev below a root, so that tests can present any machine.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace flatpose::port {

struct Cpu {
  std::vector<int> siblings;  ///< Processors that share its core, itself among them.
  std::string governor;       ///< Of its frequency; empty where there is none.
  /// What ordinary threads are given of each second by a kernel whose fair server does it.
  std::optional<std::int64_t> fair_server_ns;
};

/// What could not be read is empty: nobody is told off for what is not known.
struct Machine {
  std::string kernel;  ///< "6.1.0-18-rt-amd64"
  bool has_realtime_kernel = false;
  bool throttles_by_fair_server = false;      ///< Since 6.12; the limit of before is void there.
  std::optional<std::int64_t> rt_runtime_us;  ///< Of a second, for all of SCHED_FIFO; -1: all.
  std::vector<int> online;
  std::vector<int> isolated;
  std::map<int, Cpu> cpus;         ///< Of those online.
  std::vector<std::string> swaps;  ///< In use.
  std::optional<std::int64_t> memory_available_bytes;
  std::optional<std::int64_t> priority_limit;      ///< Of this process; -1: none.
  std::optional<std::int64_t> locked_limit_bytes;  ///< -1: none.
  bool may_set_priority = false;                   ///< CAP_SYS_NICE.
  bool may_lock_memory = false;                    ///< CAP_IPC_LOCK.
  bool may_set_cpu_latency = false;
};

[[nodiscard]] Machine read_machine(const std::string& root = {});

}  // namespace flatpose::port
