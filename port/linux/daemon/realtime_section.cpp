// [realtime]: what the search is given of the machine.

#include "port/linux/daemon/config.hpp"
#include "port/linux/daemon/section.hpp"
#include "port/linux/realtime/cpu_list.hpp"

namespace flatpose::daemon {
namespace {

constexpr Range kPriorities{0, port::kPriorityMax};
constexpr Range kLatencies_us{0, 2'000'000'000};
constexpr Range kSlacks_ns{0, 1'000'000'000};
constexpr std::size_t kCpusMax = 64;

}  // namespace

void read_realtime(Section section, Config& config) {
  port::RealtimeConfig& realtime = config.realtime;
  for (const std::int64_t cpu : section.wholes("cpus", {0, port::kCpuMax}, kCpusMax))
    realtime.cpus.push_back(static_cast<int>(cpu));
  realtime.priority = static_cast<int>(section.whole("priority", kPriorities).value_or(0));
  realtime.lock_memory = section.flag("lock_memory").value_or(false);
  if (const auto latency_us = section.whole("cpu_latency_us", kLatencies_us))
    realtime.cpu_latency_us = static_cast<std::int32_t>(*latency_us);
  realtime.timer_slack_ns = section.whole("timer_slack_ns", kSlacks_ns);
  section.finish();
  const std::string problem = port::problem_with(realtime, config.search.thread_count);
  if (!problem.empty())
    section.fail("cpus", problem, "give each thread of [search] a CPU of its own, or no CPUs");
}

}  // namespace flatpose::daemon
