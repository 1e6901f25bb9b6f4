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

std::string realtime_report(const Config& config, const std::string& root) {
  const auto list = port::advise(port::read_machine(root), config.realtime,
                                 config.search.thread_count, taken_bytes_max(config));
  if (list.empty()) return "the machine lacks nothing for real time\n";
  std::string text;
  for (const port::Advice& advice : list)
    text += "\n" + advice.what + ": " + port::printable(advice.why, port::kReasonBytesMax) +
            "\n  " + advice.command + "\n";
  return text + "\nThe search works without; its time is less certain.\n";
}

// In the words in which the daemon would say it when it starts.
std::string can_report(const CanConfig& can, const LookAtCan& look_at_can) {
  if (!can.is_on) return {};
  const port::CanInterface interface = look_at_can(can.interface);
  if (const auto problem = port::problem_of(can.interface, interface, can.need()))
    return "\ncan: " + problem->what + "\n  " + problem->remedy +
           "\n\nWith this config the daemon does not start on a machine that is so.\n";
  const std::string text = "\ncan: " + port::to_text(can.interface, interface) + "\n";
  const std::string waits = "\n\nThe daemon starts, and waits for the bus.\n";
  if (!interface.is_up)
    return text + "  " + port::command_for(can.interface, interface, can.need()) + waits;
  if (interface.is_bus_off)
    return text + "  ip link set " + port::printable(can.interface, port::kSubjectBytesMax) +
           " type can restart" + waits;
  return text;
}

}  // namespace

std::string check_report(const std::string& path, const Config& config, const std::string& root,
                         const LookAtCan& look_at_can) {
  const std::int64_t memory_bytes = held_bytes(config);
  const std::string text = port::printable(path, port::kSubjectBytesMax) + ": valid; " +
                           threads_text(config.search) + " on " + cpus_text(config.realtime) +
                           ", " + std::to_string(memory_bytes / kBytesPerMb) + " MB held, " +
                           std::to_string(taken_bytes_max(config) / kBytesPerMb) + " at most\n";
  return text + realtime_report(config, root) + can_report(config.can, look_at_can);
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
