#include "port/linux/realtime/machine.hpp"

#include <unistd.h>

#include <charconv>
#include <fstream>
#include <sstream>

#include "port/linux/realtime/cpu_list.hpp"

namespace flatpose::port {
namespace {

constexpr std::size_t kFileBytesMax = 1 << 16;
constexpr int kCapIpcLock = 14;
constexpr int kCapSysNice = 23;

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kFileBytesMax, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return text;
}

std::string first_word(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  words >> word;
  return word;
}

std::optional<std::int64_t> number_in(const std::string& word, int base = 10) {
  std::int64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value, base);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

/// The first word behind `name` at the start of a line.
std::string word_after(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(name)) return first_word(line.substr(name.size()));
  return {};
}

bool has_capability(const std::string& status, int bit) {
  const std::optional<std::int64_t> set = number_in(word_after(status, "CapEff:"), 16);
  return set && (*set >> bit & 1) != 0;
}

std::optional<std::int64_t> limit_in(const std::string& limits, const std::string& name) {
  const std::string word = word_after(limits, name);
  return word == "unlimited" ? std::optional<std::int64_t>(-1) : number_in(word);
}

/// Whether a release like "6.12.3-rt" is at least this one.
bool is_at_least(const std::string& release, int major, int minor) {
  int found_major = 0;
  int found_minor = 0;
  char dot = ' ';
  std::istringstream(release) >> found_major >> dot >> found_minor;
  return found_major > major || (found_major == major && found_minor >= minor);
}

Cpu read_cpu(const std::string& root, int number) {
  const std::string name = "cpu" + std::to_string(number);
  const std::string folder = root + "/sys/devices/system/cpu/" + name;
  Cpu cpu;
  cpu.siblings = parse_cpu_list(text_of(folder + "/topology/thread_siblings_list"));
  cpu.governor = first_word(text_of(folder + "/cpufreq/scaling_governor"));
  cpu.fair_server_ns = number_in(
      first_word(text_of(root + "/sys/kernel/debug/sched/fair_server/" + name + "/runtime")));
  return cpu;
}

std::vector<std::string> read_swaps(const std::string& root) {
  std::istringstream lines(text_of(root + "/proc/swaps"));
  std::vector<std::string> swaps;
  std::string line;
  std::getline(lines, line);  // the heads of the columns
  while (std::getline(lines, line))
    if (!first_word(line).empty()) swaps.push_back(first_word(line));
  return swaps;
}

void read_kernel(const std::string& root, Machine& machine) {
  const std::string version = text_of(root + "/proc/version");
  machine.kernel = word_after(version, "Linux version");
  machine.has_realtime_kernel = first_word(text_of(root + "/sys/kernel/realtime")) == "1" ||
                                version.find("PREEMPT_RT") != std::string::npos;
  machine.throttles_by_fair_server = is_at_least(machine.kernel, 6, 12);
  machine.rt_runtime_us =
      number_in(first_word(text_of(root + "/proc/sys/kernel/sched_rt_runtime_us")));
}

void read_rights(const std::string& root, Machine& machine) {
  const std::string status = text_of(root + "/proc/self/status");
  const std::string limits = text_of(root + "/proc/self/limits");
  machine.may_set_priority = has_capability(status, kCapSysNice);
  machine.may_lock_memory = has_capability(status, kCapIpcLock);
  machine.priority_limit = limit_in(limits, "Max realtime priority");
  machine.locked_limit_bytes = limit_in(limits, "Max locked memory");
  machine.may_set_cpu_latency = access((root + "/dev/cpu_dma_latency").c_str(), W_OK) == 0;
}

}  // namespace

Machine read_machine(const std::string& root) {
  const std::string cpus = root + "/sys/devices/system/cpu/";
  Machine machine;
  read_kernel(root, machine);
  read_rights(root, machine);
  machine.online = parse_cpu_list(text_of(cpus + "online"));
  machine.isolated = parse_cpu_list(text_of(cpus + "isolated"));
  for (const int cpu : machine.online) machine.cpus[cpu] = read_cpu(root, cpu);
  machine.swaps = read_swaps(root);
  if (const auto available_kb =
          number_in(word_after(text_of(root + "/proc/meminfo"), "MemAvailable:")))
    machine.memory_available_bytes = *available_kb * 1024;
  return machine;
}

}  // namespace flatpose::port
