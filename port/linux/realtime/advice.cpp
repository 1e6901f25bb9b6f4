#include "port/linux/realtime/advice.hpp"

#include <algorithm>

#include "port/linux/realtime/cpu_list.hpp"

namespace flatpose::port {
namespace {

#if defined(__aarch64__)
constexpr const char* kDebianMachine = "arm64";
#else
constexpr const char* kDebianMachine = "amd64";
#endif
constexpr const char* kCpuFolder = "/sys/devices/system/cpu/cpu";
constexpr std::int64_t kBytesPerMb = 1024 * 1024;
constexpr std::int64_t kFairServerUsual_ns = 50'000'000;

class Adviser {
 public:
  Adviser(const Machine& machine, const RealtimeConfig& config, int thread_count,
          std::int64_t memory_bytes)
      : machine_(machine),
        config_(config),
        thread_count_(thread_count),
        memory_bytes_(memory_bytes) {}

  std::vector<Advice> all() {
    look_at_kernel();
    look_at_cpus_given();
    look_at_isolation();
    look_at_priority();
    look_at_locked_memory();
    look_at_throttling();
    look_at_governors();
    look_at_siblings();
    look_at_cpu_latency();
    look_at_swap();
    look_at_memory();
    return std::move(list_);
  }

 private:
  void add(std::string what, std::string why, std::string command) {
    list_.push_back({std::move(what), std::move(why), std::move(command)});
  }

  /// The processors that searches run on: all when none is given.
  [[nodiscard]] const std::vector<int>& cpus() const {
    return config_.cpus.empty() ? machine_.online : config_.cpus;
  }
  /// Those of them that are there.
  [[nodiscard]] std::vector<int> found() const {
    std::vector<int> list;
    for (const int cpu : cpus())
      if (machine_.cpus.contains(cpu)) list.push_back(cpu);
    return list;
  }
  /// The last processors: the first serves interrupts before all others.
  [[nodiscard]] std::vector<int> proposed() const {
    const auto count = std::min(static_cast<std::size_t>(thread_count_), machine_.online.size());
    return {machine_.online.end() - static_cast<std::ptrdiff_t>(count), machine_.online.end()};
  }

  static std::string limit_command(const std::string& item, const std::string& value) {
    return "echo \"$USER - " + item + " " + value + "\" | sudo tee -a " +
           "/etc/security/limits.d/flatpose.conf   # and log in again; the systemd unit has it";
  }

  void look_at_kernel() {
    if (machine_.has_realtime_kernel || machine_.kernel.empty()) return;
    add("kernel", machine_.kernel + " is not PREEMPT_RT: a driver may hold a search up",
        std::string("sudo apt install linux-image-rt-") + kDebianMachine +
            "   # and start the machine again");
  }

  void look_at_cpus_given() {
    if (machine_.online.empty()) return;
    if (config_.cpus.empty())
      add("cpus", "none given: the threads of a search wander",
          "cpus = [" + comma_list(proposed()) + "]   # under [realtime] in the config");
    for (const int cpu : config_.cpus)
      if (!contains(machine_.online, cpu))
        add("cpus",
            "CPU " + std::to_string(cpu) +
                " is not online; online: " + to_cpu_list(machine_.online),
            "cpus = [" + comma_list(proposed()) + "]   # under [realtime] in the config");
    if (thread_count_ > static_cast<int>(machine_.online.size()))
      add("threads",
          std::to_string(thread_count_) + " threads on " + std::to_string(machine_.online.size()) +
              " CPUs",
          "threads = " + std::to_string(machine_.online.size()) +
              "   # under [search] in the config");
  }

  void look_at_isolation() {
    std::vector<int> open;
    for (const int cpu : config_.cpus.empty() ? proposed() : found())
      if (!contains(machine_.isolated, cpu)) open.push_back(cpu);
    if (open.empty() || machine_.online.empty()) return;
    if (cpus().size() >= machine_.online.size() && !config_.cpus.empty())
      return add("isolation", "every CPU searches: none is left for everything else",
                 "threads, cpus   # in the config: one less of each");
    const std::string list = to_cpu_list(open);
    add("isolation", "CPU " + list + " is not isolated: other work runs there too",
        "echo 'GRUB_CMDLINE_LINUX=\"$GRUB_CMDLINE_LINUX isolcpus=" + list + " nohz_full=" + list +
            " rcu_nocbs=" + list + "\"' | sudo tee /etc/default/grub.d/flatpose.cfg && " +
            "sudo update-grub   # and start the machine again");
  }

  void look_at_priority() {
    const std::int64_t wanted = std::max(config_.priority, 1);
    if (machine_.may_set_priority || !machine_.priority_limit) return;
    if (*machine_.priority_limit < 0 || *machine_.priority_limit >= wanted) return;
    add("priority",
        "this user may not use SCHED_FIFO beyond " + std::to_string(*machine_.priority_limit) +
            ": other work comes first",
        limit_command("rtprio", std::to_string(std::max(config_.priority, 80))));
  }

  void look_at_locked_memory() {
    if (machine_.may_lock_memory || !machine_.locked_limit_bytes) return;
    if (*machine_.locked_limit_bytes < 0 || *machine_.locked_limit_bytes >= memory_bytes_) return;
    add("memory lock",
        "this user may lock " + std::to_string(*machine_.locked_limit_bytes / kBytesPerMb) +
            " MB, it may take " + std::to_string(memory_bytes_ / kBytesPerMb),
        limit_command("memlock", "unlimited"));
  }

  void look_at_throttling() {
    if (machine_.throttles_by_fair_server) return look_at_fair_server();
    if (!machine_.rt_runtime_us || *machine_.rt_runtime_us < 0) return;
    add("throttling",
        "SCHED_FIFO gets " + std::to_string(*machine_.rt_runtime_us) +
            " us of each second: a search that needs more is stopped for the rest",
        "sudo sysctl -w kernel.sched_rt_runtime_us=-1");
  }

  void look_at_fair_server() {
    std::string cpus_to_mend;
    std::int64_t most_ns = 0;
    bool is_known = true;
    for (const int cpu : found()) {
      const auto given_ns = machine_.cpus.at(cpu).fair_server_ns;
      if (given_ns == 0 || contains(machine_.isolated, cpu)) continue;
      is_known = is_known && given_ns.has_value();
      most_ns = std::max(most_ns, given_ns.value_or(kFairServerUsual_ns));
      cpus_to_mend += (cpus_to_mend.empty() ? "" : " ") + std::to_string(cpu);
    }
    if (cpus_to_mend.empty()) return;
    add("throttling",
        std::string("where ordinary work waits, SCHED_FIFO is stopped for ") +
            std::to_string(most_ns / 1'000'000) + " ms of each second" +
            (is_known ? "" : ", unless that was changed: only root can see it"),
        "for i in " + cpus_to_mend +
            "; do echo 0 | sudo tee /sys/kernel/debug/sched/fair_server/cpu$i/runtime; done");
  }

  void look_at_governors() {
    std::string slow;
    std::string governor;
    for (const int cpu : found()) {
      const Cpu& one = machine_.cpus.at(cpu);
      if (one.governor.empty() || one.governor == "performance") continue;
      governor = one.governor;
      slow += (slow.empty() ? "" : " ") + std::to_string(cpu);
    }
    if (slow.empty()) return;
    add("governor", "'" + governor + "' changes the clock rate of CPU " + slow,
        "for i in " + slow + "; do echo performance | sudo tee " + kCpuFolder +
            "$i/cpufreq/scaling_governor; done");
  }

  void look_at_siblings() {
    std::vector<int> shared;
    for (const int cpu : config_.cpus.empty() ? std::vector<int>{} : found())
      for (const int other : machine_.cpus.at(cpu).siblings)
        if (other != cpu && contains(machine_.online, other)) shared.push_back(other);
    std::sort(shared.begin(), shared.end());
    shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
    std::string others;
    for (const int cpu : shared) {
      if (contains(config_.cpus, cpu)) {
        add("cores", "CPU " + std::to_string(cpu) + " shares its core with another one given",
            "cpus = [...]   # under [realtime], one of each core: see lscpu --extended");
        return;
      }
      others += (others.empty() ? "" : " ") + std::to_string(cpu);
    }
    if (others.empty()) return;
    add("cores", "CPU " + others + " runs on the core of one that searches",
        "for i in " + others + "; do echo 0 | sudo tee " + kCpuFolder + "$i/online; done");
  }

  void look_at_cpu_latency() {
    if (!config_.cpu_latency_us || machine_.may_set_cpu_latency) return;
    add("idle states", "this user may not write /dev/cpu_dma_latency",
        "echo 'KERNEL==\"cpu_dma_latency\", MODE=\"0660\", GROUP=\"flatpose\"' | sudo tee "
        "/etc/udev/rules.d/60-flatpose.rules && sudo udevadm control --reload && sudo udevadm "
        "trigger --name-match=cpu_dma_latency");
  }

  void look_at_swap() {
    if (machine_.swaps.empty()) return;
    std::string list;
    for (const std::string& swap : machine_.swaps) list += (list.empty() ? "" : ", ") + swap;
    add("swap", list + " is in use: what is not locked may be on disk when it is needed",
        "sudo swapoff -a   # and take it out of /etc/fstab");
  }

  void look_at_memory() {
    const auto& available = machine_.memory_available_bytes;
    if (!available || *available >= memory_bytes_) return;
    add("memory",
        std::to_string(*available / kBytesPerMb) + " MB are free, it may take " +
            std::to_string(memory_bytes_ / kBytesPerMb),
        "scan_width_px, scan_height_px, cell_count   # under [search]: as large as needed");
  }

  static std::string comma_list(const std::vector<int>& cpus) {
    std::string text;
    for (const int cpu : cpus) text += (text.empty() ? "" : ", ") + std::to_string(cpu);
    return text;
  }

  const Machine& machine_;
  const RealtimeConfig& config_;
  const int thread_count_;
  const std::int64_t memory_bytes_;
  std::vector<Advice> list_;
};

}  // namespace

std::vector<Advice> advise(const Machine& machine, const RealtimeConfig& config, int thread_count,
                           std::int64_t memory_bytes) {
  return Adviser(machine, config, thread_count, memory_bytes).all();
}

}  // namespace flatpose::port
