#include "port/linux/realtime/config.hpp"

#include <algorithm>

namespace flatpose::port {
namespace {

bool has_twins(std::vector<int> cpus) {
  std::sort(cpus.begin(), cpus.end());
  return std::adjacent_find(cpus.begin(), cpus.end()) != cpus.end();
}

}  // namespace

std::string problem_with(const RealtimeConfig& config, int thread_count) {
  if (config.priority < 0 || config.priority > kPriorityMax)
    return "the priority is not between 0 and " + std::to_string(kPriorityMax);
  if (config.cpus.empty()) return {};
  if (config.cpus.size() < static_cast<std::size_t>(thread_count))
    return std::to_string(thread_count) + " threads share " + std::to_string(config.cpus.size()) +
           " of the CPUs given";
  return has_twins(config.cpus) ? "a CPU is given twice" : "";
}

}  // namespace flatpose::port
