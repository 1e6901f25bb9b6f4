#include "port/linux/daemon/check.hpp"

#include "port/linux/files/input_error.hpp"
#include "port/linux/realtime/advice.hpp"
#include "port/linux/realtime/cpu_list.hpp"
#include "port/linux/realtime/machine.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::int64_t kBytesPerMb = 1 << 20;

std::string cpus_text(const port::RealtimeConfig& realtime) {
  return realtime.cpus.empty() ? "any CPU" : "CPU " + port::to_cpu_list(realtime.cpus);
}

}  // namespace

std::string check_report(const std::string& path, const Config& config, const std::string& root) {
  const std::int64_t memory_bytes = held_bytes(config);
  std::string text = port::printable(path, port::kSubjectBytesMax) + ": valid; " +
                     threads_text(config.search) + " on " + cpus_text(config.realtime) + ", " +
                     std::to_string(memory_bytes / kBytesPerMb) + " MB held, " +
                     std::to_string(taken_bytes_max(config) / kBytesPerMb) + " at most\n";
  const auto list = port::advise(port::read_machine(root), config.realtime,
                                 config.search.thread_count, taken_bytes_max(config));
  for (const port::Advice& advice : list)
    text += "\n" + advice.what + ": " + port::printable(advice.why, port::kReasonBytesMax) +
            "\n  " + advice.command + "\n";
  if (list.empty()) return text + "the machine lacks nothing for real time\n";
  return text + "\nThe search works without; its time is less certain.\n";
}

void check_memory(const std::string& path, const Config& config, const std::string& root) {
  const auto available = port::read_machine(root).memory_available_bytes;
  const std::int64_t memory_bytes = held_bytes(config);
  if (!available || *available >= memory_bytes) return;
  throw port::InputError(path,
                         "[search] needs " + std::to_string(memory_bytes / kBytesPerMb) +
                             " MB and " + std::to_string(*available / kBytesPerMb) + " are free",
                         "give a smaller scan_width_px, scan_height_px or cell_count");
}

}  // namespace flatpose::daemon
