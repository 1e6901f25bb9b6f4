#include "port/linux/daemon/warnings.hpp"

#include <algorithm>

namespace flatpose::daemon {
namespace {

constexpr std::int64_t kUsPerMs = 1000;

std::string milliseconds(std::int64_t time_us) {
  return std::to_string(time_us / kUsPerMs) + " ms";
}

}  // namespace

std::vector<std::string> warnings_of(const Config& config) {
  std::vector<std::string> lines;
  if (!config.modbus.is_on && !config.can.is_on)
    lines.emplace_back("no [modbus] and no [can]: nobody can ask for anything");
  for (const JobConfig& job : config.jobs) {
    const bool has_pdos_alone = config.can.is_on && !config.can.node.fd_frame;
    if (has_pdos_alone && job.rule.convention == Convention::kAbbQuaternion)
      lines.push_back("job " + std::to_string(job.rule.job) +
                      ": a quaternion has no room in CAN's PDOs, where its status is "
                      "out_of_range; on an FD bus fd_frame has");
  }
  if (!config.source.is_any()) lines.emplace_back("no [source]: there are no scans");
  if (config.jobs.empty()) lines.emplace_back("no [[job]]: every trigger is refused");
  if (!config.source.replay.empty() && !config.source.allow_simulated)
    lines.emplace_back("replayed scans make no pose without allow_simulated = true in [source]");
  return lines;
}

std::optional<std::string> lease_advice(const Config& config) {
  const bool beats = config.can.node.master_silence_ms != 0;
  if (!config.can.is_on || beats || config.jobs.empty()) return {};
  const JobConfig& slowest = *std::max_element(config.jobs.begin(), config.jobs.end(),
                                               [](const JobConfig& a, const JobConfig& b) {
                                                 return a.rule.answer_by_us < b.rule.answer_by_us;
                                               });
  const std::int64_t lease_us = config.lease_us.value_or(job::Config{}.lease_us);
  if (slowest.rule.answer_by_us <= lease_us) return {};
  return "job " + std::to_string(slowest.rule.job) + " answers within " +
         milliseconds(slowest.rule.answer_by_us) + ", and a master silent for " +
         milliseconds(lease_us) +
         " (lease_ms) is given up and its command cancelled\n  meanwhile send RPDO1 with "
         "command_number 0, or the heartbeat of node " +
         std::to_string(config.can.node.master) +
         "; or write lease_ms = " + std::to_string(slowest.rule.answer_by_us / kUsPerMs) +
         " in [can]";
}

}  // namespace flatpose::daemon
