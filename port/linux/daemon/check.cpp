#include "port/linux/daemon/check.hpp"

#include <optional>

#include "port/linux/daemon/warnings.hpp"
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

std::string megabytes(std::int64_t bytes) { return std::to_string(bytes / kBytesPerMb) + " MB"; }

/// In the words in which the daemon would say it when it starts; none: it starts.
struct NoStart {
  std::string what;
  std::string remedy;
};

std::optional<NoStart> lack_of_memory(const Config& config, const std::string& root) {
  const auto available = port::read_machine(root).memory_available_bytes;
  const std::int64_t memory_bytes = held_bytes(config);
  if (!available || *available >= memory_bytes) return {};
  return NoStart{
      "[search] needs " + megabytes(memory_bytes) + " and " + megabytes(*available) + " are free",
      "give a smaller scan_width_px, scan_height_px or cell_count"};
}

std::optional<NoStart> why_not_started(const Config& config, const std::string& root,
                                       const port::CanInterface& interface) {
  if (auto lack = lack_of_memory(config, root)) return lack;
  if (!config.can.is_on) return {};
  const auto problem = port::problem_of(config.can.interface, interface, config.can.need());
  if (!problem) return {};
  return NoStart{problem->what, problem->remedy};
}

// Of one that a node can be on.
std::string can_report(const CanConfig& can, const port::CanInterface& interface) {
  std::string text = "\ncan: " + port::to_text(can.interface, interface) + "\n";
  const std::string waits = "\n\nThe daemon starts, and waits for the bus.\n";
  if (!interface.is_up) {
    text += "  " + port::command_for(can.interface, interface, can.need()) + waits;
  } else if (interface.is_bus_off) {
    text += "  ip link set " + port::printable(can.interface, port::kSubjectBytesMax) +
            " type can restart" + waits;
  }
  const auto doubt = port::doubt_of(can.interface, interface, can.need());
  return doubt ? text + "\nwarning: " + *doubt + "\n" : text;
}

}  // namespace

std::string check_report(const std::string& path, const Config& config, const std::string& root,
                         const LookAtCan& look_at_can) {
  const port::CanInterface interface =
      config.can.is_on ? look_at_can(config.can.interface) : port::CanInterface{};
  const auto no_start = why_not_started(config, root, interface);
  std::string text = port::printable(path, port::kSubjectBytesMax) + ": valid";
  text += no_start ? ", but the daemon would not start on this machine: " + no_start->what +
                         "\n  " + no_start->remedy + "\n\n"
                   : std::string("; ");
  text += threads_text(config.search) + " on " + cpus_text(config.realtime) + ", " +
          megabytes(held_bytes(config)) + " held, " +
          std::to_string(taken_bytes_max(config) / kBytesPerMb) + " at most\n";
  text += realtime_report(config, root);
  if (config.can.is_on && !port::problem_of(config.can.interface, interface, config.can.need()))
    text += can_report(config.can, interface);
  const auto advice = lease_advice(config);
  return advice ? text + "\nlease: " + *advice + "\n" : text;
}

void check_memory(const std::string& path, const Config& config, const std::string& root) {
  if (const auto lack = lack_of_memory(config, root))
    throw port::InputError(path, lack->what, lack->remedy);
}

}  // namespace flatpose::daemon
